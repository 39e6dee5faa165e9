// One arm's set point.
#include "axis.h"

namespace beatrix {

Fine reach_of(Fine speed, Fine acceleration) {
  Fine n = speed / acceleration;
  Fine rest = speed - n * acceleration;
  return acceleration * (n * (n + 1) / 2) + (n + 1) * rest;
}

Ramp make_ramp(Fine top, Fine acceleration) {
  Ramp ramp = {{top, reach_of(top, acceleration)}, acceleration};
  return ramp;
}

static int32_t leading_steps(Fine position, int8_t direction) {
  return direction > 0 ? ceil_steps(position) : floor_steps(position);
}

void Axis::place(int32_t steps) {
  steps_ = steps;
  position_ = start_ = target_ = to_fine(steps);
  pace_.speed = pace_.reach = 0;
}

void Axis::follow(int32_t target, const Ramp &ramp) {
  target_ = to_fine(target);
  if (pace_.speed && ramp.acceleration != ramp_.acceleration) {
    pace_.reach = reach_of(pace_.speed, ramp.acceleration);
  }
  ramp_ = ramp;
}

void Axis::plan() {
  int8_t direction = direction_;
  if (halted()) direction = target_ < position_ ? -1 : 1;
  Fine left = direction > 0 ? target_ - position_ : position_ - target_;
  if (lands(left)) {
    next_.pace.speed = next_.pace.reach = 0;
    next_.position = next_.rest = target_;
    next_.rest_steps = floor_steps(target_);
    next_.direction = direction;
  } else {
    set_next(choose(left), direction);
  }
}

void Axis::brake() { set_next(slower(), direction_); }

void Axis::commit() {
  bool moved = next_.position != position_;
  start_ = position_;
  position_ = next_.position;
  pace_ = next_.pace;
  if (moved) {
    direction_ = next_.direction;
    steps_ = leading_steps(position_, direction_);
  }
}

// The fastest pace that still comes to rest within what is left. The present one always leaves room for a slower one,
// unless the target has been moved inside the stopping distance: then braking is all that can be done.
Pace Axis::choose(Fine left) const {
  if (pace_.speed <= ramp_.top.speed) {
    Pace up = faster();
    if (up.reach <= left) return up;
    if (pace_.reach <= left) return pace_;
  }
  return slower();
}

Pace Axis::faster() const {
  Fine speed = pace_.speed + ramp_.acceleration;
  if (speed >= ramp_.top.speed) return ramp_.top;
  Pace up = {speed, pace_.reach + speed};
  return up;
}

Pace Axis::slower() const {
  Pace down = {0, 0};
  if (pace_.speed > ramp_.acceleration) {
    down.speed = pace_.speed - ramp_.acceleration;
    down.reach = pace_.reach - pace_.speed;
  }
  return down;
}

// The last rest is made in one tick, if that changes the speed by no more than the acceleration.
bool Axis::lands(Fine left) const {
  return left >= 0 && left <= ramp_.acceleration && pace_.speed <= left + ramp_.acceleration;
}

void Axis::set_next(const Pace &pace, int8_t direction) {
  next_.pace = pace;
  next_.direction = direction;
  next_.position = direction > 0 ? position_ + pace.speed : position_ - pace.speed;
  next_.rest = direction > 0 ? position_ + pace.reach : position_ - pace.reach;
  next_.rest_steps = pace.speed ? leading_steps(next_.rest, direction) : steps_;
}

}  // namespace beatrix
