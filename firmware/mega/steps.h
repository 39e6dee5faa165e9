// Step pulses: each arm's next train of evenly spaced steps, made by the compare interrupts of Timer 1.
#ifndef BEATRIX_MEGA_STEPS_H
#define BEATRIX_MEGA_STEPS_H

#include <stdint.h>

namespace beatrix {
namespace mega {

// Evenly spaced steps of one arm, all in one direction. Times are those of Timer 1, in cycles.
struct Train {
  uint16_t first;
  uint16_t interval;
  uint8_t count;
  bool forward;
  bool rare;  // so few that each can be made in its very cycle
};

void start_steps();
// Cycles since some moment, wrapping every 4 ms. With interrupts off only.
uint16_t now();
// Make these steps, after those that are queued; there is room for one train beside the one being made. Dropped while the
// drivers are off: switching them off has ended every motion.
void queue_train(uint8_t arm, const Train &train);

}  // namespace mega
}  // namespace beatrix

#endif
