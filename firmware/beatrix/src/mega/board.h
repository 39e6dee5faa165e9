// The board: call begin() once, then run() in a loop.
#ifndef BEATRIX_MEGA_BOARD_H
#define BEATRIX_MEGA_BOARD_H

#include "../core/contract.h"

namespace beatrix {

// Take over timers 1 and 3, UART 0 and the watchdog, stop the other timers, and switch the motors off.
void begin(uint32_t baud);
// Run the main loop once: process received bytes, call poll() after a tick, then sleep until an interrupt.
void run();

}  // namespace beatrix

#endif
