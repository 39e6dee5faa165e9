// Set point of one arm: a trapezoidal speed profile whose target can change at any tick.
#ifndef BEATRIX_AXIS_H
#define BEATRIX_AXIS_H

#include "contract.h"
#include "fixed_point.h"

namespace beatrix {

// Acceleration and top speed of an arm.
struct Ramp {
  Fixed acceleration;  // per tick, > 0
  Fixed top;
  Fixed stopping_distance;  // from top speed to rest, with one tick at top speed
};

// Return an estimate of speed / ACCELERATION in ticks; the error is at most one tick.
uint16_t ticks_to_rest(const Fixed &speed);
// Return v + (v - a) + (v - 2a) + ... down to rest. `ticks` estimates the number of terms; a loop corrects it, and
// takes less time if the estimate is better.
Fixed stopping_distance_of(const Fixed &speed, const Fixed &acceleration, uint16_t ticks);
void set_ramp(const Fixed &top, const Fixed &acceleration, uint16_t ticks, Ramp *ramp);

// Every tick is planned first (plan or brake), can be checked (next_rest, next_rest_steps) and is then committed
// (commit). A tick needs only additions and comparisons, because the rest position is updated incrementally: it is
// constant while the arm brakes, moves by v in a tick at constant speed v, and by v + (v + a) if it accelerates by a.
class Axis {
 public:
  // Set the position to `steps`, at rest.
  void place(int32_t steps);
  // Set the position to the last step, at rest.
  void place_at_last_step() { place(steps_); }
  // Set the target: from rest, or in motion with an unchanged acceleration.
  void follow(int32_t target, const Ramp &ramp);
  // Set the target in motion with another acceleration: pass what rest_with() returns for it to follow().
  Fixed rest_with(const Fixed &acceleration) const;
  void follow(int32_t target, const Ramp &ramp, const Fixed &rest);

  // Plan the next tick: as fast as top speed, acceleration and the distance to go allow.
  void plan();
  // Plan a slower next tick.
  void brake() { brake_with(ramp_.acceleration, rest_); }
  void brake_with(const Fixed &acceleration, const Fixed &rest);
  void commit();
  // Record a tick without motion.
  void no_motion() { start_ = position_; }

  // Return whether braking would overshoot the target and the arm is slow enough to stop at once.
  bool may_stop_at_once() const;
  // Plan a stop at the present position; check it before stop_at_once().
  void plan_stop_at_once();
  void stop_at_once();

  // Step count, rounded up in the direction of travel, so that a motion makes its first step in its first tick.
  int32_t steps() const { return steps_; }
  int32_t target() const { return floor_steps(target_); }
  // Set point at the start and end of the last tick, from which the step times are calculated.
  const Fixed &start() const { return start_; }
  const Fixed &end() const { return position_; }
  Fixed velocity() const { return direction_ > 0 ? speed_ : -speed_; }
  const Fixed &acceleration() const { return ramp_.acceleration; }
  bool at_rest() const { return speed_ == Fixed(); }
  bool arrived() const { return at_rest() && position_ == target_; }

  // Rest position if the arm brakes after the planned tick: exact, and in steps.
  const Fixed &next_rest() const { return next_rest_; }
  int32_t next_rest_steps() const { return next_rest_steps_; }

 private:
  bool reaches_target() const;
  bool plan_faster(const Fixed &present_rest);
  bool beyond_target(const Fixed &rest) const;
  void set_next(const Fixed &speed, const Fixed &rest);

  // This order keeps most operands of a tick within the 64 bytes that an AVR addresses from one pointer.
  Fixed speed_;  // of the last tick, >= 0
  Fixed rest_;   // rest position if braking starts in the next tick
  Fixed position_;
  Fixed target_;
  Fixed next_rest_;        // with next_speed_ 0: the end of the motion
  int8_t direction_ = 1;  // of the last tick that moved
  int8_t next_direction_ = 1;
  int32_t next_rest_steps_ = 0;
  Ramp ramp_ = Ramp();
  Fixed next_speed_;  // of the planned tick
  Fixed start_;
  int32_t steps_ = 0;
};

}  // namespace beatrix

#endif
