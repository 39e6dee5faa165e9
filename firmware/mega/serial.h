// The wire to the host: UART 0 behind two ring buffers.
#ifndef BEATRIX_MEGA_SERIAL_H
#define BEATRIX_MEGA_SERIAL_H

#include <stdint.h>

namespace beatrix {
namespace mega {

void start_serial(uint32_t baud);
bool has_byte();
// Of those received, the oldest; only if there is one.
uint8_t take_byte();

}  // namespace mega
}  // namespace beatrix

#endif
