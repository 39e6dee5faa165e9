// Times of the steps of one millisecond: converts set points to cycles of Timer 1; does not access the hardware.
#ifndef BEATRIX_MEGA_STEP_TIMES_H
#define BEATRIX_MEGA_STEP_TIMES_H

#include "../core/axis.h"
#include "steps.h"

namespace beatrix {
namespace mega {

static const uint16_t TICK_CYCLES = 16000;

// Interval of several steps in a tick, which at constant speed is computed only once.
struct Interval {
  uint32_t distance;  // of the tick
  uint16_t cycles;
};

// Compute the steps of an axis in its last tick. `before`: step count at the start of the tick; `begin`: cycle at which
// the millisecond starts; `last`: the axis's last interval. Return false if there are no steps.
bool next_train(const Axis &axis, int32_t before, uint16_t begin, Interval *last, StepTrain *train);

}  // namespace mega
}  // namespace beatrix

#endif
