// Motion of the three arms.
#include "../speed.h"
#include "motion.h"

namespace beatrix {

static const uint64_t SLOWEST_RATIO = ONE >> 4;

static uint32_t distance(int32_t from, int32_t to) { return uint32_t(to > from ? to - from : from - to); }

static void set_full_ramp(const Fixed &top, Ramp *ramp) {
  set_ramp(top, from_q26(ACCELERATION), ticks_to_rest(top), ramp);
}

void Motion::measure(const Move &move, uint32_t distance_to_go[ARMS], bool *resting) const {
  for (uint8_t i = 0; i < ARMS; i++) distance_to_go[i] = distance(axes_[i].steps(), move.target[i]);
  *resting = !moving_;
}

void Motion::plan(const Move &move, bool straight, const uint32_t distance_to_go[ARMS], bool resting, Plan *plan) const {
  for (uint8_t i = 0; i < ARMS; i++) plan->target[i] = move.target[i];
  if (straight) return plan_straight(from_quarters(move.speed[0]), distance_to_go, resting, plan);
  for (uint8_t i = 0; i < ARMS; i++) set_full_ramp(from_quarters(move.speed[i]), &plan->ramp[i]);
}

void Motion::plan_straight(const Fixed &top, const uint32_t distance_to_go[ARMS], bool resting, Plan *plan) const {
  uint32_t most = 1;
  for (uint8_t i = 0; i < ARMS; i++) most = distance_to_go[i] > most ? distance_to_go[i] : most;
  uint16_t ticks = ticks_to_rest(top);
  for (uint8_t i = 0; i < ARMS; i++) {
    uint64_t share = resting ? ratio(distance_to_go[i], most) : rough_ratio(distance_to_go[i], most);
    if (resting && share) {
      set_ramp(scaled(top, share), scaled(from_q26(ACCELERATION), share), ticks, &plan->ramp[i]);
    } else {
      // An arm in motion may have to turn back over more than its distance, so its speed has a minimum.
      set_full_ramp(scaled(top, share > SLOWEST_RATIO ? share : SLOWEST_RATIO), &plan->ramp[i]);
    }
  }
}

void Motion::follow(const Plan &plan) {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].follow(plan.target[i], plan.ramp[i]);
}

// The arms of a straight motion brake in proportion to their paths; a new motion may brake them with other
// accelerations. If they would then stop outside the limits, they brake as before, and the new motion starts from rest.
void Motion::start(const Plan &plan) {
  if (moving_ && !same_accelerations(plan)) {
    follow_or_brake_first(plan);
  } else {
    follow(plan);
    braking_ = false;
  }
  if (!braking_) stop_slow_axes();
  brake_reason_ = outcome_ = OUTCOME_NONE;
  moving_ = true;
}

bool Motion::same_accelerations(const Plan &plan) const {
  for (uint8_t i = 0; i < ARMS; i++) {
    if (plan.ramp[i].acceleration != axes_[i].acceleration()) return false;
  }
  return true;
}

void Motion::follow_or_brake_first(const Plan &plan) {
  Fixed rest[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    const Fixed &acceleration = plan.ramp[i].acceleration;
    rest[i] = axes_[i].rest_with(acceleration);
    axes_[i].brake_with(acceleration, rest[i]);  // only for the check: every tick plans again
  }
  braking_ = check_tick(axes_) != OUTCOME_NONE;
  if (braking_) {
    next_ = plan;
  } else {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].follow(plan.target[i], plan.ramp[i], rest[i]);
  }
}

// Stop slow arms that turn back, so that they make no further step in the old direction, unless an arm that continues
// would then come too close.
void Motion::stop_slow_axes() {
  bool any = false;
  for (uint8_t i = 0; i < ARMS; i++) {
    axes_[i].brake();
    if (!axes_[i].may_stop_at_once()) continue;
    axes_[i].plan_stop_at_once();
    any = true;
  }
  if (!any || check_tick(axes_) != OUTCOME_NONE) return;
  for (uint8_t i = 0; i < ARMS; i++) {
    if (axes_[i].may_stop_at_once()) axes_[i].stop_at_once();
  }
}

void Motion::brake(Outcome why) {
  if (!moving_ || (braking_ && brake_reason_ != OUTCOME_NONE)) return;
  braking_ = true;
  brake_reason_ = why;
}

void Motion::abort(Outcome why, const int16_t discarded_steps[ARMS]) {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].place(axes_[i].steps() - discarded_steps[i]);
  if (!moving_) return;
  moving_ = braking_ = false;
  outcome_ = why;
}

void Motion::set_home() {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].place(0);
}

void Motion::tick() {
  if (!moving_) {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].no_motion();
    return;
  }
  if (!braking_) {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].plan();
    Outcome forbidden = check_tick(axes_);
    if (forbidden != OUTCOME_NONE) brake(forbidden);
  }
  if (braking_) brake_all();
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].commit();
  finish();
}

void Motion::brake_all() {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].brake();
}

void Motion::finish() {
  for (uint8_t i = 0; i < ARMS; i++) {
    if (!(braking_ ? axes_[i].at_rest() : axes_[i].arrived())) return;
  }
  if (!braking_) {
    moving_ = false;
    outcome_ = OUTCOME_DONE;
    return;
  }
  // This changes the exact positions by less than a step, so it is done only now, when all arms rest.
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].place_at_last_step();
  braking_ = false;
  if (brake_reason_ == OUTCOME_NONE) {
    follow(next_);
  } else {
    moving_ = false;
    outcome_ = brake_reason_;
  }
}

}  // namespace beatrix
