// When the steps of one millisecond are due: from set points to cycles of the timer. No hardware in here.
#ifndef BEATRIX_MEGA_TIMING_H
#define BEATRIX_MEGA_TIMING_H

#include "../core/axis.h"
#include "steps.h"

namespace beatrix {
namespace mega {

static const uint16_t TICK_CYCLES = 16000;

// The steps an axis asks for in its last tick, which had made `before` at its begin; the millisecond begins at `begin`.
// False: none.
bool make_train(const Axis &axis, int32_t before, uint16_t begin, Train *train);

}  // namespace mega
}  // namespace beatrix

#endif
