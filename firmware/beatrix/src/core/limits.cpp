// Limits of the arms.
//
// Checking the rest positions is enough. While all arms brake with the same acceleration (in a straight motion, in
// proportion to their speeds), the difference of two arms changes monotonically. It therefore stays between its present
// value, which has been checked, and its value at rest. The sum of three arms is not monotonic, so each arm counts with
// its extreme value. Steps are rounded up in the direction of travel, so both steps and exact positions are compared.
#include "../speed.h"
#include "limits.h"

namespace beatrix {

static int32_t least_difference(uint8_t arm) { return difference_at(arm, GAP_MIN); }

static int32_t larger(int32_t a, int32_t b) { return a > b ? a : b; }
static int32_t smaller(int32_t a, int32_t b) { return a < b ? a : b; }

Outcome check_steps(const int32_t steps[ARMS]) {
  int32_t sum = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    if (steps[next_arm(i)] - steps[i] < least_difference(i)) return OUTCOME_GAP;
    sum += steps[i];
  }
  return sum > YAW_SUM_MAX || sum < -YAW_SUM_MAX ? OUTCOME_YAW : OUTCOME_NONE;
}

static bool gap_allowed(const Axis &arm, const Axis &next, int32_t least) {
  int32_t then = next.next_rest_steps() - arm.next_rest_steps();
  if (then > least + 1) return true;  // the exact difference is less than two steps smaller
  if (then >= least && next.next_rest() - arm.next_rest() >= to_fixed(least)) return true;
  int32_t now = next.steps() - arm.steps();
  return now < least && then >= now;
}

static bool yaw_allowed(const Axis axes[ARMS]) {
  int32_t now = 0, then = 0, highest = 0, lowest = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    int32_t steps = axes[i].steps(), rest = axes[i].next_rest_steps();
    now += steps;
    then += rest;
    highest += larger(steps, rest);
    lowest += smaller(steps, rest);
  }
  if (highest <= YAW_SUM_MAX && lowest >= -YAW_SUM_MAX) return true;
  return (now > YAW_SUM_MAX && then <= now) || (now < -YAW_SUM_MAX && then >= now);
}

Outcome check_tick(const Axis axes[ARMS]) {
  for (uint8_t i = 0; i < ARMS; i++) {
    if (!gap_allowed(axes[i], axes[next_arm(i)], least_difference(i))) return OUTCOME_GAP;
  }
  return yaw_allowed(axes) ? OUTCOME_NONE : OUTCOME_YAW;
}

}  // namespace beatrix
