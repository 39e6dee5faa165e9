// The guard from places where no motion can bring the arms.
#include "guard.h"

using namespace beatrix;

extern "C" int guard_first_tick(const int32_t start[ARMS], const int32_t target[ARMS]) {
  Axis axes[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    axes[i].place(start[i]);
    axes[i].follow(target[i], make_ramp(from_quarters(SPEED_DEFAULT), from_q26(ACCELERATION)));
    axes[i].plan();
  }
  return guard_tick(axes);
}
