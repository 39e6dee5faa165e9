// One arm's set point: a trapezoid of speed that can be given another target at any tick.
#ifndef BEATRIX_AXIS_H
#define BEATRIX_AXIS_H

#include "units.h"

namespace beatrix {

// A speed and how far the arm still goes at it: this tick's move and those of every slower tick to rest.
struct Pace {
  Fine speed;  // >= 0
  Fine reach;
};

// How fast an arm may go and how quickly it gets there.
struct Ramp {
  Pace top;
  Fine acceleration;  // per tick, > 0
};

// v + (v - a) + (v - 2a) + ... down to rest: the sum a tick-by-tick stop from `speed` travels. One division.
Fine reach_of(Fine speed, Fine acceleration);
Ramp make_ramp(Fine top, Fine acceleration);

// Every tick is planned first (plan or brake), may be looked at (next_rest, next_rest_steps) and is then made (commit).
// Only additions and comparisons: reach is carried along, gaining v + a with every faster tick, losing v with a slower.
class Axis {
 public:
  // Rest at `steps`.
  void place(int32_t steps);
  // Rest where the last step went.
  void settle() { place(steps_); }
  // Go to `target`, from rest or in motion.
  void follow(int32_t target, const Ramp &ramp);

  // Next tick: as fast as speed limit, acceleration and the way that is left allow.
  void plan();
  // Next tick: slower.
  void brake();
  void commit();
  // A tick without motion.
  void idle() { start_ = position_; }

  // Steps made so far, leading in the direction of travel: the first step of a motion is made in its first tick.
  int32_t steps() const { return steps_; }
  int32_t target() const { return floor_steps(target_); }
  // Where the last tick began and ended: the step engine derives the times of its steps from these.
  Fine start() const { return start_; }
  Fine end() const { return position_; }
  Fine velocity() const { return direction_ > 0 ? pace_.speed : -pace_.speed; }
  bool halted() const { return pace_.speed == 0; }
  bool arrived() const { return halted() && position_ == target_; }

  // Where the arm rests if it brakes after the planned tick; exactly, and in steps made then.
  Fine next_rest() const { return next_.rest; }
  int32_t next_rest_steps() const { return next_.rest_steps; }

 private:
  struct Next {
    Pace pace;
    Fine position;
    Fine rest;
    int32_t rest_steps;
    int8_t direction;
  };

  Pace choose(Fine left) const;
  Pace faster() const;
  Pace slower() const;
  bool lands(Fine left) const;
  void set_next(const Pace &pace, int8_t direction);

  Fine position_ = 0;
  Fine start_ = 0;
  Fine target_ = 0;
  Pace pace_ = {0, 0};  // of the last tick
  Ramp ramp_ = {{0, 0}, 1};
  Next next_ = {{0, 0}, 0, 0, 0, 1};
  int32_t steps_ = 0;
  int8_t direction_ = 1;  // of the last tick that moved
};

}  // namespace beatrix

#endif
