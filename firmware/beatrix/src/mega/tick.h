// The planner's tick: once a millisecond it queues the steps of the next millisecond.
#ifndef BEATRIX_MEGA_TICK_H
#define BEATRIX_MEGA_TICK_H

#include "../core/machine.h"

namespace beatrix {
namespace mega {

// Start Timer 3, which calls the tick. Call after start_steps().
void start_tick(Machine &machine);
// Return true if a tick has run since the last clear_tick_done().
bool tick_done();
void clear_tick_done();

}  // namespace mega
}  // namespace beatrix

#endif
