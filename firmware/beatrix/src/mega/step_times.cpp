// Times of the steps of one millisecond.
//
// The set point moves evenly within a tick. A step is due when the set point leaves an integer, so the first one is due
// at the next integer, the others one step apart. One division for each arm gives the time of a single step, or the
// interval of several.
#include "../speed.h"
#include "step_times.h"

namespace beatrix {
namespace mega {

namespace {

const uint8_t DISTANCE_BITS = 24;  // distance of a tick in 32 bits: up to 256 steps
const uint32_t ONE_STEP = uint32_t(1) << DISTANCE_BITS;
// Cycles from which an interval is sparse: with three arms, waiting for sparse steps takes at most a tenth of the time.
const uint16_t SPARSE_INTERVAL = 4096;

uint32_t to_tick_distance(const Fixed &value) {
  return uint32_t(value.high) << (DISTANCE_BITS - 8) | value.low >> (FRACTION_BITS - DISTANCE_BITS);
}

// Return the distance from the start to the first integer, or 0 if the arm has just reversed between two integers.
uint32_t distance_to_first(const Fixed &start, int32_t before, bool forward) {
  if ((floor_steps(start) == before) == forward) return 0;
  return (forward ? -to_tick_distance(start) : to_tick_distance(start)) & (ONE_STEP - 1);
}

// Return 65536 * part / value as an integer, at most 65535.
uint16_t fraction(uint32_t part, uint32_t value) {
  if (part >= value) return 0xFFFF;
  if (value >= uint32_t(1) << 23) {
    value >>= 8;
    part >>= 8;
  }
  uint24 rest = uint24(part);
  return quotient_bits(&rest, uint24(value));
}

uint16_t times(uint16_t fraction_of, uint16_t cycles) { return uint16_t(multiply(fraction_of, cycles) >> 16); }

}  // namespace

bool next_train(const Axis &axis, int32_t before, uint16_t begin, Interval *last, StepTrain *train) {
  int8_t steps = int8_t(axis.steps() - before);
  if (!steps) return false;
  bool forward = steps > 0;
  uint32_t distance = to_tick_distance(forward ? axis.end() - axis.start() : axis.start() - axis.end());
  uint32_t first = distance_to_first(axis.start(), before, forward);
  train->forward = forward;
  train->count = uint8_t(forward ? steps : -steps);
  if (train->count == 1) {
    // An arm placed at its last step has distance 0: its step is made at once.
    train->interval = 0;
    train->sparse = true;
    train->first = uint16_t(begin + (distance ? times(fraction(first, distance), TICK_CYCLES) : 0));
  } else {
    if (distance != last->distance) {
      last->distance = distance;
      last->cycles = times(fraction(ONE_STEP, distance), TICK_CYCLES);
    }
    train->interval = last->cycles;
    train->sparse = train->interval >= SPARSE_INTERVAL;
    train->first = uint16_t(begin + times(uint16_t(first >> (DISTANCE_BITS - 16)), train->interval));
  }
  return true;
}

}  // namespace mega
}  // namespace beatrix
