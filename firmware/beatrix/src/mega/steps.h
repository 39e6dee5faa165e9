// Step pulses: trains of evenly spaced steps for each arm, made by the compare interrupts of Timer 1.
#ifndef BEATRIX_MEGA_STEPS_H
#define BEATRIX_MEGA_STEPS_H

#include <stdint.h>

namespace beatrix {
namespace mega {

// Evenly spaced steps of one arm in one direction. Times are cycles of Timer 1.
struct StepTrain {
  uint16_t first;
  uint16_t interval;
  uint8_t count;
  bool forward;
  bool sparse;  // the steps are so far apart that each can be made in its exact cycle
};

void start_steps();
// Return the cycle counter, which wraps every 4 ms. Call with interrupts disabled.
uint16_t now();
// Queue these steps; there is room for one train beside the current one. While the drivers are off the train is
// dropped, because switching them off has ended every motion.
void queue_train(uint8_t arm, const StepTrain &train);

}  // namespace mega
}  // namespace beatrix

#endif
