// The limits that nobody may cross: gaps between neighbouring arms, and the turn of them all.
#ifndef BEATRIX_GUARD_H
#define BEATRIX_GUARD_H

#include "axis.h"
#include "contract.h"

namespace beatrix {

static const uint8_t ARMS = 3;

inline uint8_t next_arm(uint8_t arm) { return uint8_t(arm < ARMS - 1 ? arm + 1 : 0); }

// Difference to the next arm at which there is this gap between them (the last one's next is the first, a turn further).
inline int32_t difference_at(uint8_t arm, int32_t gap) {
  return gap - (arm < ARMS - 1 ? ARM_SPACING : ARM_TURN - (ARMS - 1) * ARM_SPACING);
}

// GAP, YAW, or NONE if arms at these steps are within the limits.
Outcome guard_steps(const int32_t steps[ARMS]);

// The same for the planned tick: NONE if braking right after it ends within the limits, or further inside them than
// the arms are now.
Outcome guard_tick(const Axis axes[ARMS]);

}  // namespace beatrix

#endif
