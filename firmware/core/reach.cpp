// How far along a straight line the arms may go.
//
// Every limit here is a plane: the gaps between neighbours from below (guard, tilt) and from above (tilt), and the sum
// of the arms. Beyond a plane a line stays beyond it, so the nearest plane on the way decides.
//
// The tilt of the head depends on the differences of the arms only, and the firmware knows no kinematics: with all gaps
// between TILT_GAP_MIN and TILT_GAP_MAX the head surely tilts no further than it may (see robot.toml).
#include "reach.h"

namespace beatrix {

// The guard counts an arm that comes back as not yet back: so many steps two of them need to stop from TEXT_SPEED, and
// one more each because steps lead.
static const int32_t YAW_ROOM = 16;
static const int32_t WITHIN_GUARD = YAW_SUM_MAX - YAW_ROOM;
static const int32_t YAW_MAX = TEXT_YAW_SUM_MAX < WITHIN_GUARD ? TEXT_YAW_SUM_MAX : WITHIN_GUARD;

namespace {

// A part of the way, as a fraction: divided at the end only, once for each arm.
struct Part {
  int32_t go, of;
  Warning why;
};

// `from` and `to`: what the limit is about, at both ends of the way.
void limit(Part &part, int32_t from, int32_t to, int32_t most, Warning why) {
  if (from > most) most = from;
  if (to <= most) return;
  int32_t go = most - from, of = to - from;
  if (int64_t(go) * part.of >= int64_t(part.go) * of) return;
  part.go = go;
  part.of = of;
  part.why = why;
}

}  // namespace

Warning shorten(const int32_t start[ARMS], int32_t target[ARMS]) {
  Part part = {1, 1, WITHIN_REACH};
  int32_t from_sum = 0, to_sum = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    uint8_t next = next_arm(i);
    int32_t from = start[next] - start[i], to = target[next] - target[i];
    limit(part, -from, -to, -difference_at(i, GAP_MIN), WARNING_GAP);
    limit(part, -from, -to, -difference_at(i, TILT_GAP_MIN), WARNING_TILT);
    limit(part, from, to, difference_at(i, TILT_GAP_MAX), WARNING_TILT);
    from_sum += start[i];
    to_sum += target[i];
  }
  limit(part, from_sum, to_sum, YAW_MAX, WARNING_YAW);
  limit(part, -from_sum, -to_sum, YAW_MAX, WARNING_YAW);
  if (part.why != WITHIN_REACH) {
    for (uint8_t i = 0; i < ARMS; i++) {
      target[i] = start[i] + int32_t(int64_t(target[i] - start[i]) * part.go / part.of);
    }
  }
  return part.why;
}

}  // namespace beatrix
