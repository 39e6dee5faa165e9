// The wire to the host: UART 0 behind two ring buffers.
#ifndef BEATRIX_MEGA_SERIAL_H
#define BEATRIX_MEGA_SERIAL_H

#include <stdint.h>

namespace beatrix {
namespace mega {

// 256 bytes, indexed by bytes that wrap by themselves. Each index is written on one side only, so no side has to keep
// interrupts off.
struct Ring {
  volatile uint8_t head;  // next to be written
  volatile uint8_t tail;  // next to be read
  uint8_t bytes[256];
};

extern Ring received;

void start_serial(uint32_t baud);

// Inline: the main loop calls them for every byte.
inline bool has_byte() { return received.head != received.tail; }
// Of those received, the oldest; only if there is one.
inline uint8_t take_byte() {
  uint8_t tail = received.tail;
  uint8_t byte = received.bytes[tail];
  received.tail = uint8_t(tail + 1);
  return byte;
}

}  // namespace mega
}  // namespace beatrix

#endif
