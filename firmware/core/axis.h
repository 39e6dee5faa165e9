// One arm's set point: a trapezoid of speed that can be given another target at any tick.
#ifndef BEATRIX_AXIS_H
#define BEATRIX_AXIS_H

#include "contract.h"
#include "units.h"

namespace beatrix {

// How fast an arm may go and how quickly it gets there.
struct Ramp {
  Fine acceleration;  // per tick, > 0
  Fine top;
  Fine reach;  // from top: how far the arm still goes, this tick's move and those of every slower tick to rest
};

// How often ACCELERATION can be taken from a speed, or once more or less.
uint16_t ticks_to_rest(const Fine &speed);
// v + (v - a) + (v - 2a) + ... down to rest: the sum a tick-by-tick stop from `speed` travels. `ticks` as above: the
// nearer, the sooner it is done.
Fine reach_of(const Fine &speed, const Fine &acceleration, uint16_t ticks);
void set_ramp(const Fine &top, const Fine &acceleration, uint16_t ticks, Ramp *ramp);

// Every tick is planned first (plan or brake), may be looked at (next_rest, next_rest_steps) and is then made (commit).
// Only additions and comparisons: the place of rest is carried along. It stays while braking, and goes on by v in a tick
// at speed v, by v + (v + a) in one that is faster by a.
class Axis {
 public:
  // Rest at `steps`.
  void place(int32_t steps);
  // Rest where the last step went.
  void settle() { place(steps_); }
  // Go to `target`: from rest, or in motion with the same acceleration.
  void follow(int32_t target, const Ramp &ramp);
  // With another one: where braking with it ends, and then that as well.
  Fine rest_with(const Fine &acceleration) const;
  void follow(int32_t target, const Ramp &ramp, const Fine &rest);

  // Next tick: as fast as speed limit, acceleration and the way that is left allow.
  void plan();
  // Next tick: slower.
  void brake() { brake_with(ramp_.acceleration, rest_); }
  void brake_with(const Fine &acceleration, const Fine &rest);
  void commit();
  // A tick without motion.
  void idle() { start_ = position_; }

  // Steps made so far, leading in the direction of travel: the first step of a motion is made in its first tick.
  int32_t steps() const { return steps_; }
  int32_t target() const { return floor_steps(target_); }
  // Where the last tick began and ended: the step engine derives the times of its steps from these.
  const Fine &start() const { return start_; }
  const Fine &end() const { return position_; }
  Fine velocity() const { return direction_ > 0 ? speed_ : -speed_; }
  const Fine &acceleration() const { return ramp_.acceleration; }
  bool halted() const { return speed_ == Fine(); }
  bool arrived() const { return halted() && position_ == target_; }

  // Where the arm rests if it brakes after the planned tick; exactly, and in steps made then.
  const Fine &next_rest() const { return next_rest_; }
  int32_t next_rest_steps() const { return next_rest_steps_; }

 private:
  bool lands() const;
  bool speeds_up(const Fine &present_rest);
  bool beyond_target(const Fine &rest) const;
  void set_next(const Fine &speed, const Fine &rest);

  // In this order, nearly all that a tick adds and compares lies in the 64 bytes that an AVR reaches from one address.
  Fine speed_;  // of the last tick, >= 0
  Fine rest_;   // where braking from the next tick on ends
  Fine position_;
  Fine target_;
  Fine next_rest_;        // at speed 0 the place where it ends
  int8_t direction_ = 1;  // of the last tick that moved
  int8_t next_direction_ = 1;
  int32_t next_rest_steps_ = 0;
  Ramp ramp_ = Ramp();
  Fine next_speed_;  // of the planned tick
  Fine start_;
  int32_t steps_ = 0;
};

}  // namespace beatrix

#endif
