// Shortens text motions to the limits.
//
// Every limit is a plane: minimum gaps (limits.h, tilt), maximum gaps (tilt) and the sum of the arms. A line crosses a
// plane once, so the first plane on the line decides.
//
// Tilt depends on the differences of the arms only. The firmware has no kinematics, so it limits the gaps: with all of
// them between TILT_GAP_MIN and TILT_GAP_MAX, the tilt stays within its limit (see robot.toml).
#include "../speed.h"
#include "text_limits.h"

namespace beatrix {

// Margin to the yaw limit of limits.h, which counts each arm with its extreme value: the stopping distance of two arms
// at TEXT_SPEED, and one more step for each, because steps are rounded up.
static const int32_t YAW_ROOM = 16;
static const int32_t WITHIN_GUARD = YAW_SUM_MAX - YAW_ROOM;
static const int32_t YAW_MAX = TEXT_YAW_SUM_MAX < WITHIN_GUARD ? TEXT_YAW_SUM_MAX : WITHIN_GUARD;

namespace {

// The allowed part of the line as a fraction, so that only the result needs a division.
struct Fraction {
  int32_t numerator, denominator;
  Warning warning;
};

// Shorten the line to the limit `most`. `from` and `to`: the limited quantity at both ends of the line.
void apply_limit(Fraction &fraction, int32_t from, int32_t to, int32_t most, Warning warning) {
  if (from > most) most = from;
  if (to <= most) return;
  int32_t numerator = most - from, denominator = to - from;
  if (int64_t(numerator) * fraction.denominator >= int64_t(fraction.numerator) * denominator) return;
  fraction.numerator = numerator;
  fraction.denominator = denominator;
  fraction.warning = warning;
}

}  // namespace

Warning shorten_to_limits(const int32_t start[ARMS], int32_t target[ARMS]) {
  Fraction fraction = {1, 1, NOT_SHORTENED};
  int32_t from_sum = 0, to_sum = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    uint8_t next = next_arm(i);
    int32_t from = start[next] - start[i], to = target[next] - target[i];
    apply_limit(fraction, -from, -to, -difference_at(i, GAP_MIN), WARNING_GAP);
    apply_limit(fraction, -from, -to, -difference_at(i, TILT_GAP_MIN), WARNING_TILT);
    apply_limit(fraction, from, to, difference_at(i, TILT_GAP_MAX), WARNING_TILT);
    from_sum += start[i];
    to_sum += target[i];
  }
  apply_limit(fraction, from_sum, to_sum, YAW_MAX, WARNING_YAW);
  apply_limit(fraction, -from_sum, -to_sum, YAW_MAX, WARNING_YAW);
  if (fraction.warning != NOT_SHORTENED) {
    for (uint8_t i = 0; i < ARMS; i++) {
      target[i] = start[i] + int32_t(int64_t(target[i] - start[i]) * fraction.numerator / fraction.denominator);
    }
  }
  return fraction.warning;
}

}  // namespace beatrix
