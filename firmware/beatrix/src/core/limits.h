// Limits of the arms: gaps between neighbours, and yaw.
#ifndef BEATRIX_LIMITS_H
#define BEATRIX_LIMITS_H

#include "axis.h"
#include "contract.h"

namespace beatrix {

static const uint8_t ARMS = 3;

inline uint8_t next_arm(uint8_t arm) { return uint8_t(arm < ARMS - 1 ? arm + 1 : 0); }

// Return the step count of the next arm minus that of this arm if the gap between them is `gap`. The arm after the last
// one is the first one, one turn further.
inline int32_t difference_at(uint8_t arm, int32_t gap) {
  return gap - (arm < ARMS - 1 ? ARM_SPACING : ARM_TURN - (ARMS - 1) * ARM_SPACING);
}

// Return OUTCOME_GAP or OUTCOME_YAW for the limit that arms at these steps violate, or OUTCOME_NONE.
Outcome check_steps(const int32_t steps[ARMS]);

// Return OUTCOME_NONE if braking right after the planned tick ends within the limits, or no further beyond them than
// now, otherwise OUTCOME_GAP or OUTCOME_YAW for the violated limit.
Outcome check_tick(const Axis axes[ARMS]);

}  // namespace beatrix

#endif
