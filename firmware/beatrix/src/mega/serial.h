// Serial line to the host: UART 0 with two ring buffers.
#ifndef BEATRIX_MEGA_SERIAL_H
#define BEATRIX_MEGA_SERIAL_H

#include "../core/receive_buffer.h"

namespace beatrix {
namespace mega {

// Ring buffer of 256 bytes; its 8-bit indices wrap. Each index is written on one side only, so neither side disables
// interrupts.
struct TransmitBuffer {
  volatile uint8_t head;  // next to write
  volatile uint8_t tail;  // next to read
  uint8_t bytes[256];
};

extern ReceiveBuffer receive_buffer;

void start_serial(uint32_t baud);

}  // namespace mega
}  // namespace beatrix

#endif
