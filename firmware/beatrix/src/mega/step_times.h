// Times of the steps of one millisecond: from set points to cycles of Timer 1. Without hardware access.
#ifndef BEATRIX_MEGA_STEP_TIMES_H
#define BEATRIX_MEGA_STEP_TIMES_H

#include "../core/axis.h"
#include "steps.h"

namespace beatrix {
namespace mega {

static const uint16_t TICK_CYCLES = 16000;

// The steps of an axis in its last tick, with `before` steps at its start; the millisecond starts at `begin`. False: no
// steps.
bool next_train(const Axis &axis, int32_t before, uint16_t begin, StepTrain *train);

}  // namespace mega
}  // namespace beatrix

#endif
