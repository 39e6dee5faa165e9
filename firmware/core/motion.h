// Three arms in motion: towards a target, braking, within the guard's limits.
#ifndef BEATRIX_MOTION_H
#define BEATRIX_MOTION_H

#include "guard.h"

namespace beatrix {

// Where a motion goes and how: what start() needs, worked out beforehand with all divisions.
struct Plan {
  int32_t target[ARMS] = {};
  Ramp ramp[ARMS];
};

class Motion {
 public:
  // The way each arm has to go, read before plan(); `resting` says whether all of them rest.
  void survey(const Move &move, uint32_t todo[ARMS], bool *resting) const;
  // Straight: speed[0] is that of the arm with most to do, the others are slowed in proportion; from rest their
  // accelerations are as well, so that all start and arrive together.
  void plan(const Move &move, bool straight, const uint32_t todo[ARMS], bool resting, Plan *plan) const;
  // Takes the place of a running motion.
  void start(const Plan &plan);
  // Brake to rest from the next tick on; the first reason counts.
  void brake(Outcome why);
  // Rest at once, where the last steps went: the drivers are off, and some steps were not made.
  void abort(Outcome why, const int16_t unmade[ARMS]);
  // At rest only: the present position becomes home.
  void zero();
  void tick();

  const Axis &axis(uint8_t i) const { return axes_[i]; }
  bool moving() const { return moving_; }
  bool braking() const { return braking_; }
  Outcome outcome() const { return outcome_; }

 private:
  void plan_straight(const Fine &top, const uint32_t todo[ARMS], bool resting, Plan *plan) const;
  bool brakes_alike(const Plan &plan) const;
  void try_to_follow(const Plan &plan);
  void follow(const Plan &plan);
  void brake_all();
  void finish();

  Axis axes_[ARMS];
  Plan next_ = Plan();
  Outcome why_ = OUTCOME_NONE;      // braking for this reason; NONE: to start next_ from rest
  Outcome outcome_ = OUTCOME_NONE;
  bool moving_ = false;
  bool braking_ = false;
};

}  // namespace beatrix

#endif
