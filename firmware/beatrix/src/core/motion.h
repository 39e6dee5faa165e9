// Motion of the three arms: towards a target or braking, within the limits.
#ifndef BEATRIX_MOTION_H
#define BEATRIX_MOTION_H

#include "limits.h"

namespace beatrix {

// Targets and ramps for start(). plan() computes them, because their divisions must not delay the tick.
struct Plan {
  int32_t target[ARMS] = {};
  Ramp ramp[ARMS];
};

class Motion {
 public:
  // Set the distance of each arm to its target, and whether all arms rest, for plan().
  void measure(const Move &move, uint32_t distance_to_go[ARMS], bool *resting) const;
  // Plan a motion. Straight: speed[0] is the speed of the arm with the longest distance, and the others are slower in
  // proportion to theirs. From rest they also accelerate less, so that all arms start and arrive together.
  void plan(const Move &move, bool straight, const uint32_t distance_to_go[ARMS], bool resting, Plan *plan) const;
  // Start a motion; it replaces a running one.
  void start(const Plan &plan);
  // Brake to rest from the next tick on; the first reason is reported.
  void brake(Outcome why);
  // End the motion at the last steps made: the drivers are off, and `discarded_steps` of each arm were not made.
  void abort(Outcome why, const int16_t discarded_steps[ARMS]);
  // Declare the present position home; all arms must be at rest.
  void set_home();
  void tick();

  const Axis &axis(uint8_t i) const { return axes_[i]; }
  bool moving() const { return moving_; }
  bool braking() const { return braking_; }
  Outcome outcome() const { return outcome_; }

 private:
  void plan_straight(const Fixed &top, const uint32_t distance_to_go[ARMS], bool resting, Plan *plan) const;
  bool same_accelerations(const Plan &plan) const;
  void follow_or_brake_first(const Plan &plan);
  void follow(const Plan &plan);
  void stop_slow_axes();
  void brake_all();
  void finish();

  Axis axes_[ARMS];
  Plan next_ = Plan();
  Outcome brake_reason_ = OUTCOME_NONE;      // reported after braking; NONE: start next_ from rest
  Outcome outcome_ = OUTCOME_NONE;
  bool moving_ = false;
  bool braking_ = false;
};

}  // namespace beatrix

#endif
