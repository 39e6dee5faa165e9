// The board: call begin() once, then run() in a loop.
#ifndef BEATRIX_MEGA_BOARD_H
#define BEATRIX_MEGA_BOARD_H

#include "../core/contract.h"

namespace beatrix {

// Takes over timers 1 and 3, UART 0 and the watchdog, stops the other timers, and switches the motors off.
void begin(uint32_t baud);
// One iteration of the main loop: processes received bytes, calls poll() after a tick, then sleeps until an interrupt.
void run();

}  // namespace beatrix

#endif
