// Checksum of the serial link.
#ifndef BEATRIX_CRC_H
#define BEATRIX_CRC_H

#include <stdint.h>

namespace beatrix {

static const uint16_t CRC_START = 0xFFFF;

// Return a CRC-16/MCRF4XX (polynomial 0x1021, reflected) extended by one byte. It is computed with shifts, because a
// table of 512 bytes would take a sixteenth of the AVR's RAM.
inline uint16_t crc_add(uint16_t crc, uint8_t byte) {
  uint8_t x = uint8_t(byte ^ crc);
  x = uint8_t(x ^ (x << 4));
  return uint16_t((crc >> 8) ^ (uint16_t(x) << 8) ^ (uint16_t(x) << 3) ^ (x >> 4));
}

}  // namespace beatrix

#endif
