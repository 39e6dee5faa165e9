// Three arms in motion.
#include "motion.h"

namespace beatrix {

static const uint64_t SLOWEST_RATIO = WHOLE >> 4;

static uint32_t distance(int32_t from, int32_t to) { return uint32_t(to > from ? to - from : from - to); }

void Motion::survey(const int32_t target[ARMS], uint32_t todo[ARMS], bool *resting) const {
  for (uint8_t i = 0; i < ARMS; i++) todo[i] = distance(axes_[i].steps(), target[i]);
  *resting = !moving_;
}

Plan Motion::plan(const Move &move, const uint32_t todo[ARMS], bool resting) const {
  uint32_t most = 1;
  for (uint8_t i = 0; i < ARMS; i++) most = todo[i] > most ? todo[i] : most;
  Fine acceleration = from_q26(limits.acceleration);
  Fine top = from_quarters(move.speed[0]);
  uint32_t ticks = ticks_to_rest(top, acceleration);
  Plan plan;
  for (uint8_t i = 0; i < ARMS; i++) {
    plan.target[i] = move.target[i];
    if (!(move.flags & MOVE_STRAIGHT)) {
      plan.ramp[i] = make_ramp(from_quarters(move.speed[i]), acceleration);
      continue;
    }
    uint64_t ratio = ratio_of(todo[i], most);
    if (resting && ratio) {
      plan.ramp[i] = make_ramp(scaled(top, ratio), scaled(acceleration, ratio), ticks);
    } else {
      // In motion an arm may have to turn back, however little it has to do: it must not crawl.
      plan.ramp[i] = make_ramp(scaled(top, ratio > SLOWEST_RATIO ? ratio : SLOWEST_RATIO), acceleration);
    }
  }
  return plan;
}

void Motion::follow(const Plan &plan) {
  for (uint8_t i = 0; i < ARMS; i++) axes_[i].follow(plan.target[i], plan.ramp[i]);
}

// A straight motion brakes in proportion, its successor with full ramps. Where that would end outside the limits,
// this motion is braked first and the new one starts from rest.
void Motion::start(const Plan &plan) {
  braking_ = moving_ && !brakes_alike(plan) && !can_follow(plan);
  if (braking_) {
    next_ = plan;
  } else {
    follow(plan);
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

bool Motion::can_follow(const Plan &plan) const {
  Axis axes[ARMS] = {axes_[0], axes_[1], axes_[2]};
  for (uint8_t i = 0; i < ARMS; i++) {
    axes[i].follow(plan.target[i], plan.ramp[i]);
    axes[i].brake();
  }
  return guard_tick(axes) == OUTCOME_NONE;
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
