// Set point of one arm.
#include "../speed.h"
#include "axis.h"

namespace beatrix {

void set_ramp(const Fixed &top, const Fixed &acceleration, uint16_t ticks, Ramp *ramp) {
  ramp->acceleration = acceleration;
  ramp->top = top;
  ramp->stopping_distance = stopping_distance_of(top, acceleration, ticks);
}

// 2^30 / ACCELERATION, the factor for a speed with 12 fractional bits.
static const uint16_t INVERSE = uint16_t((uint32_t(1) << 30) / ACCELERATION);
static_assert(ACCELERATION > 1 << 14, "its inverse has 16 bits");
static_assert(int64_t(SPEED_MAX) * 16777 / ACCELERATION < 0xFFFF, "the ticks of a stop are counted in 16 bits");

uint16_t ticks_to_rest(const Fixed &speed) {
  uint16_t coarse = uint16_t(uint16_t(speed.high) << 4 | uint8_t(speed.low >> 24) >> 4);
  return uint16_t(multiply(coarse, INVERSE) >> 16);
}

__attribute__((noinline)) Fixed stopping_distance_of(const Fixed &speed, const Fixed &acceleration, uint16_t ticks) {
  Fixed rest = speed - acceleration * ticks;
  for (; rest < Fixed(); ticks--) rest = rest + acceleration;
  for (; rest >= acceleration; ticks++) rest = rest - acceleration;
  // Sum of an arithmetic series.
  return half((speed + rest) * uint16_t(ticks + 1));
}

static inline int32_t rounded_ahead(const Fixed &position, int8_t direction) {
  return direction > 0 ? ceil_steps(position) : floor_steps(position);
}

static inline Fixed advanced(const Fixed &position, const Fixed &distance, int8_t direction) {
  return direction > 0 ? position + distance : position - distance;
}

void Axis::place(int32_t steps) {
  steps_ = steps;
  position_ = start_ = target_ = rest_ = to_fixed(steps);
  speed_ = Fixed();
}

void Axis::follow(int32_t target, const Ramp &ramp) {
  target_ = to_fixed(target);
  ramp_ = ramp;
}

Fixed Axis::rest_with(const Fixed &acceleration) const {
  if (at_rest() || acceleration == ramp_.acceleration) return rest_;
  return advanced(position_, stopping_distance_of(speed_, acceleration, ticks_to_rest(speed_)) - speed_, direction_);
}

void Axis::follow(int32_t target, const Ramp &ramp, const Fixed &rest) {
  follow(target, ramp);
  rest_ = rest;
}

// Largest stopping distance, in microsteps, at which an arm may stop at once. At this distance it turns slower than 130
// microsteps/s, and a motor can start or stop without a ramp at ten times that speed.
static const int32_t STOP_AT_ONCE_MAX = 4;

bool Axis::may_stop_at_once() const {
  if (at_rest()) return false;
  bool beyond = direction_ > 0 ? rest_ > target_ : rest_ < target_;
  int32_t distance = rounded_ahead(rest_, direction_) - steps_;
  return beyond && distance <= STOP_AT_ONCE_MAX && distance >= -STOP_AT_ONCE_MAX;
}

void Axis::plan_stop_at_once() {
  next_rest_ = position_;
  next_rest_steps_ = steps_;
}

void Axis::stop_at_once() {
  speed_ = Fixed();
  rest_ = position_;
}

// Choose the highest speed from which the arm can still stop at its target. If a new target lies within the stopping
// distance, there is no such speed, and the arm brakes.
void Axis::plan() {
  next_direction_ = direction_;
  if (at_rest()) next_direction_ = target_ < position_ ? -1 : 1;
  if (reaches_target()) {
    next_speed_ = Fixed();
    next_rest_ = target_;
    next_rest_steps_ = floor_steps(target_);
    return;
  }
  Fixed rest = advanced(rest_, speed_, next_direction_);
  if (speed_ > ramp_.top || beyond_target(rest)) {
    brake();
  } else if (speed_ == ramp_.top || !plan_faster(rest)) {
    set_next(speed_, rest);
  }
}

// Accelerate, or return false if the arm could then not stop at its target. `present_rest` is the rest position at the
// present speed.
bool Axis::plan_faster(const Fixed &present_rest) {
  Fixed speed = speed_ + ramp_.acceleration;
  bool top = speed >= ramp_.top;
  if (top) speed = ramp_.top;
  Fixed rest = top ? advanced(position_, ramp_.stopping_distance, next_direction_)
                   : advanced(present_rest, speed, next_direction_);
  if (beyond_target(rest)) return false;
  set_next(speed, rest);
  return true;
}

bool Axis::beyond_target(const Fixed &rest) const { return next_direction_ > 0 ? rest > target_ : rest < target_; }

void Axis::brake_with(const Fixed &acceleration, const Fixed &rest) {
  next_direction_ = direction_;
  if (speed_ > acceleration) {
    set_next(speed_ - acceleration, rest);
  } else {
    next_speed_ = Fixed();
    next_rest_ = position_;
    next_rest_steps_ = steps_;
  }
}

void Axis::commit() {
  start_ = position_;
  speed_ = next_speed_;
  rest_ = next_rest_;
  if (!at_rest()) {
    position_ = advanced(position_, speed_, next_direction_);
  } else if (position_ == rest_) {
    return;
  } else {
    position_ = rest_;
  }
  direction_ = next_direction_;
  steps_ = rounded_ahead(position_, direction_);
}

// Return whether the motion can end at the target in the next tick without exceeding the acceleration.
bool Axis::reaches_target() const {
  int32_t left_high = next_direction_ > 0 ? target_.high - position_.high : position_.high - target_.high;
  if (left_high < 0 || left_high > ramp_.acceleration.high + 1) return false;  // the cheap check first
  Fixed left = next_direction_ > 0 ? target_ - position_ : position_ - target_;
  return left >= Fixed() && left <= ramp_.acceleration && speed_ <= left + ramp_.acceleration;
}

void Axis::set_next(const Fixed &speed, const Fixed &rest) {
  next_speed_ = speed;
  next_rest_ = rest;
  next_rest_steps_ = rounded_ahead(rest, next_direction_);
}

}  // namespace beatrix
