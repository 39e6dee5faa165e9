// One arm's set point.
#include "axis.h"

namespace beatrix {

void set_ramp(const Fine &top, const Fine &acceleration, uint16_t ticks, Ramp *ramp) {
  ramp->acceleration = acceleration;
  ramp->top = top;
  ramp->reach = reach_of(top, acceleration, ticks);
}

// 1 / ACCELERATION with two binary places, of speeds with 12.
static const uint16_t INVERSE = uint16_t((uint32_t(1) << 30) / ACCELERATION);
static_assert(ACCELERATION > 1 << 14, "its inverse has 16 bits");
static_assert(int64_t(SPEED_MAX) * 16777 / ACCELERATION < 0xFFFF, "the ticks of a stop are counted in 16 bits");

uint16_t ticks_to_rest(const Fine &speed) {
  uint16_t coarse = uint16_t(uint16_t(speed.high) << 4 | uint8_t(speed.low >> 24) >> 4);
  return uint16_t(wide(coarse, INVERSE) >> 16);
}

__attribute__((noinline)) Fine reach_of(const Fine &speed, const Fine &acceleration, uint16_t ticks) {
  Fine rest = speed - acceleration * ticks;
  for (; rest < Fine(); ticks--) rest = rest + acceleration;
  for (; rest >= acceleration; ticks++) rest = rest - acceleration;
  // The mean of the first and the last, as often as there are.
  return half((speed + rest) * uint16_t(ticks + 1));
}

static inline int32_t leading_steps(const Fine &position, int8_t direction) {
  return direction > 0 ? ceil_steps(position) : floor_steps(position);
}

static inline Fine along(const Fine &position, const Fine &way, int8_t direction) {
  return direction > 0 ? position + way : position - way;
}

void Axis::place(int32_t steps) {
  steps_ = steps;
  position_ = start_ = target_ = rest_ = to_fine(steps);
  speed_ = Fine();
}

void Axis::follow(int32_t target, const Ramp &ramp) {
  target_ = to_fine(target);
  ramp_ = ramp;
}

Fine Axis::rest_with(const Fine &acceleration) const {
  if (halted() || acceleration == ramp_.acceleration) return rest_;
  return along(position_, reach_of(speed_, acceleration, ticks_to_rest(speed_)) - speed_, direction_);
}

void Axis::follow(int32_t target, const Ramp &ramp, const Fine &rest) {
  follow(target, ramp);
  rest_ = rest;
}

// The fastest speed from which the arm still comes to rest before its target. The present one always leaves room for a
// slower one, unless the target has been moved inside the stopping distance: then braking is all that can be done.
void Axis::plan() {
  next_direction_ = direction_;
  if (halted()) next_direction_ = target_ < position_ ? -1 : 1;
  if (lands()) {
    next_speed_ = Fine();
    next_rest_ = target_;
    next_rest_steps_ = floor_steps(target_);
    return;
  }
  Fine rest = along(rest_, speed_, next_direction_);
  if (speed_ > ramp_.top || beyond_target(rest)) {
    brake();
  } else if (speed_ == ramp_.top || !speeds_up(rest)) {
    set_next(speed_, rest);
  }
}

// Faster by the acceleration, if that leaves way enough to rest; `present_rest` is the place of rest at the present speed.
bool Axis::speeds_up(const Fine &present_rest) {
  Fine speed = speed_ + ramp_.acceleration;
  bool top = speed >= ramp_.top;
  if (top) speed = ramp_.top;
  Fine rest = top ? along(position_, ramp_.reach, next_direction_) : along(present_rest, speed, next_direction_);
  if (beyond_target(rest)) return false;
  set_next(speed, rest);
  return true;
}

bool Axis::beyond_target(const Fine &rest) const { return next_direction_ > 0 ? rest > target_ : rest < target_; }

void Axis::brake_with(const Fine &acceleration, const Fine &rest) {
  next_direction_ = direction_;
  if (speed_ > acceleration) {
    set_next(speed_ - acceleration, rest);
  } else {
    next_speed_ = Fine();
    next_rest_ = position_;
    next_rest_steps_ = steps_;
  }
}

void Axis::commit() {
  start_ = position_;
  speed_ = next_speed_;
  rest_ = next_rest_;
  if (!halted()) {
    position_ = along(position_, speed_, next_direction_);
  } else if (position_ == rest_) {
    return;
  } else {
    position_ = rest_;
  }
  direction_ = next_direction_;
  steps_ = leading_steps(position_, direction_);
}

// The last rest is made in one tick, if that changes the speed by no more than the acceleration.
bool Axis::lands() const {
  int32_t left_high = next_direction_ > 0 ? target_.high - position_.high : position_.high - target_.high;
  if (left_high < 0 || left_high > ramp_.acceleration.high + 1) return false;  // spares exact figures, nearly always
  Fine left = next_direction_ > 0 ? target_ - position_ : position_ - target_;
  return left >= Fine() && left <= ramp_.acceleration && speed_ <= left + ramp_.acceleration;
}

void Axis::set_next(const Fine &speed, const Fine &rest) {
  next_speed_ = speed;
  next_rest_ = rest;
  next_rest_steps_ = leading_steps(rest, next_direction_);
}

}  // namespace beatrix
