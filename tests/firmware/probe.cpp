// Probes of the core alone: its limits at positions that no motion reaches, and millions of ticks of random motions.
#include "motion.h"

using namespace beatrix;

extern "C" int check_first_tick(const int32_t start[ARMS], const int32_t target[ARMS]) {
  Axis axes[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    axes[i].place(start[i]);
    Ramp ramp;
    Fixed top = from_quarters(SPEED_MAX / 3);
    set_ramp(top, from_q26(ACCELERATION), ticks_to_rest(top), &ramp);
    axes[i].follow(target[i], ramp);
    axes[i].plan();
  }
  return check_tick(axes);
}

namespace {

class Chance {
 public:
  explicit Chance(uint32_t seed) : state_(seed * 2654435761U + 1) {}

  // The generator of Numerical Recipes. Its low bits are not random enough, so they are dropped.
  int32_t between(int32_t low, int32_t high) {
    state_ = state_ * 1664525U + 1013904223U;
    return low + int32_t((uint64_t(state_ >> 8) * uint64_t(high - low + 1)) >> 24);
  }

 private:
  uint32_t state_;
};

struct Seen {
  int64_t ticks, crossed, steep, trips, missed;
};

// Return a move to a target close to a limit: arms close together, or turned far.
Move any_move(Chance &chance, bool far) {
  Move move;
  int32_t turn = far ? chance.between(2200, 2340) * (chance.between(0, 1) ? 1 : -1) : chance.between(-300, 300);
  int32_t apart = far ? chance.between(1, 500) : chance.between(0, 1) ? 1058 : 529;
  for (uint8_t i = 0; i < ARMS; i++) {
    move.target[i] = int16_t(turn + chance.between(-apart, apart));
    move.speed[i] = uint16_t(chance.between(chance.between(0, 3) ? 1500 : 1, SPEED_MAX));
  }
  return move;
}

void check_state(const Motion &motion, const Fixed before[ARMS], bool settled, bool fresh, Seen *seen) {
  int32_t steps[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    const Axis &axis = motion.axis(i);
    steps[i] = axis.steps();
    Fixed change = axis.end() - axis.start() - before[i];
    // The last tick of a motion changes the speed by up to `a`, and the first of a new one by as much again.
    Fixed allowed = from_q26(ACCELERATION * (fresh ? 2 : 1));
    // A slow arm may also stop at once to turn back.
    Fixed speed = before[i] < Fixed() ? -before[i] : before[i];
    if (fresh && speed < from_quarters(4 * 150)) allowed = allowed + speed;
    if (!settled && (change > allowed || change < -allowed)) seen->steep++;
    if (!motion.moving() && motion.outcome() == OUTCOME_DONE && axis.end() != to_fixed(axis.target())) seen->missed++;
  }
  if (check_steps(steps) != OUTCOME_NONE) seen->crossed++;
}

void run_ticks(Motion &motion, int32_t ticks, Seen *seen) {
  for (int32_t t = 0; t < ticks; t++) {
    Fixed before[ARMS];
    for (uint8_t i = 0; i < ARMS; i++) before[i] = motion.axis(i).end() - motion.axis(i).start();
    bool moved = motion.moving(), braked = motion.braking();
    motion.tick();
    // After braking, all arms are placed at their last steps, which is not a change of speed.
    bool settled = braked && !motion.braking();
    check_state(motion, before, settled, t == 0, seen);
    if (moved && !motion.moving() && (motion.outcome() == OUTCOME_GAP || motion.outcome() == OUTCOME_YAW)) seen->trips++;
    seen->ticks++;
  }
}

}  // namespace

extern "C" void live(uint32_t seed, uint32_t motions, Seen *seen) {
  Chance chance(seed);
  Motion motion;
  for (uint32_t i = 0; i < motions; i++) {
    Move move = any_move(chance, i / 100 % 2);
    int32_t target[ARMS];
    for (uint8_t arm = 0; arm < ARMS; arm++) target[arm] = move.target[arm];
    if (check_steps(target) == OUTCOME_NONE) {
      uint32_t distance_to_go[ARMS];
      bool resting;
      motion.measure(move, distance_to_go, &resting);
      Plan plan;
      motion.plan(move, chance.between(0, 1), distance_to_go, resting, &plan);
      motion.start(plan);
    }
    if (chance.between(0, 9) == 0) motion.brake(OUTCOME_STOPPED);
    run_ticks(motion, chance.between(1, chance.between(0, 3) ? 300 : 4000), seen);
  }
}
