// Three arms in motion.
#include "motion.h"

namespace beatrix {

static const uint64_t SLOWEST_RATIO = WHOLE >> 4;

static uint32_t distance(int32_t from, int32_t to) { return uint32_t(to > from ? to - from : from - to); }

static void set_full_ramp(const Fine &top, Ramp *ramp) {
  set_ramp(top, from_q26(ACCELERATION), ticks_to_rest(top), ramp);
}

void Motion::survey(const Move &move, uint32_t todo[ARMS], bool *resting) const {
  for (uint8_t i = 0; i < ARMS; i++) todo[i] = distance(axes_[i].steps(), move.target[i]);
  *resting = !moving_;
}

void Motion::plan(const Move &move, bool straight, const uint32_t todo[ARMS], bool resting, Plan *plan) const {
  for (uint8_t i = 0; i < ARMS; i++) plan->target[i] = move.target[i];
  if (straight) return plan_straight(from_quarters(move.speed[0]), todo, resting, plan);
  for (uint8_t i = 0; i < ARMS; i++) set_full_ramp(from_quarters(move.speed[i]), &plan->ramp[i]);
}

void Motion::plan_straight(const Fine &top, const uint32_t todo[ARMS], bool resting, Plan *plan) const {
  uint32_t most = 1;
  for (uint8_t i = 0; i < ARMS; i++) most = todo[i] > most ? todo[i] : most;
  uint16_t ticks = ticks_to_rest(top);
  for (uint8_t i = 0; i < ARMS; i++) {
    uint64_t ratio = resting ? ratio_of(todo[i], most) : rough_ratio_of(todo[i], most);
    if (resting && ratio) {
      set_ramp(scaled(top, ratio), scaled(from_q26(ACCELERATION), ratio), ticks, &plan->ramp[i]);
    } else {
      // In motion an arm may have to turn back, however little it has to do: it must not crawl.
      set_full_ramp(scaled(top, ratio > SLOWEST_RATIO ? ratio : SLOWEST_RATIO), &plan->ramp[i]);
    }
  }
}

void Motion::follow(const Plan &plan) {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].follow(plan.target[i], plan.ramp[i]);
}

// A straight motion brakes in proportion, its successor with full ramps. Where that would end outside the limits,
// this motion is braked first and the new one starts from rest.
void Motion::start(const Plan &plan) {
  if (moving_ && !brakes_alike(plan)) {
    try_to_follow(plan);
  } else {
    follow(plan);
    braking_ = false;
  }
  why_ = outcome_ = OUTCOME_NONE;
  moving_ = true;
}

bool Motion::brakes_alike(const Plan &plan) const {
  for (uint8_t i = 0; i < ARMS; i++) {
    if (plan.ramp[i].acceleration != axes_[i].acceleration()) return false;
  }
  return true;
}

void Motion::try_to_follow(const Plan &plan) {
  Fine rest[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    const Fine &acceleration = plan.ramp[i].acceleration;
    rest[i] = axes_[i].rest_with(acceleration);
    axes_[i].brake_with(acceleration, rest[i]);  // to be looked at only: every tick plans anew
  }
  braking_ = guard_tick(axes_) != OUTCOME_NONE;
  if (braking_) {
    next_ = plan;
  } else {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].follow(plan.target[i], plan.ramp[i], rest[i]);
  }
}

void Motion::brake(Outcome why) {
  if (!moving_ || (braking_ && why_ != OUTCOME_NONE)) return;
  braking_ = true;
  why_ = why;
}

void Motion::abort(Outcome why, const int16_t unmade[ARMS]) {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].place(axes_[i].steps() - unmade[i]);
  if (!moving_) return;
  moving_ = braking_ = false;
  outcome_ = why;
}

void Motion::zero() {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].place(0);
}

void Motion::tick() {
  if (!moving_) {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].idle();
    return;
  }
  if (!braking_) {
    for (uint8_t i = 0; i < ARMS; i++) axes_[i].plan();
    Outcome forbidden = guard_tick(axes_);
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
    if (!(braking_ ? axes_[i].halted() : axes_[i].arrived())) return;
  }
  if (!braking_) {
    moving_ = false;
    outcome_ = OUTCOME_DONE;
    return;
  }
  // Only now, when all of them rest: settling moves the exact position by less than a step.
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].settle();
  braking_ = false;
  if (why_ == OUTCOME_NONE) {
    follow(next_);
  } else {
    moving_ = false;
    outcome_ = why_;
  }
}

}  // namespace beatrix
