// The planner's tick, once a millisecond, and the times of the steps it asks for.
#ifndef BEATRIX_MEGA_TICK_H
#define BEATRIX_MEGA_TICK_H

#include "../core/machine.h"

namespace beatrix {
namespace mega {

// After start_steps(): both timers count in step.
void start_tick(Machine &machine);
// Whether there was a tick since the last forget_tick().
bool tick_made();
void forget_tick();

}  // namespace mega
}  // namespace beatrix

#endif
