// When the steps of one millisecond are due.
//
// In one tick the set point moves evenly. A step belongs to the moment it leaves a whole number, so the first is due
// after the way to the next whole number, the others a whole way apart. One division an arm: of a single step its
// time, of several their interval.
#include "timing.h"

namespace beatrix {
namespace mega {

namespace {

const uint8_t WAY_BITS = 24;  // the way of a tick in 32 bits: up to 256 steps
const uint32_t WAY_ONE = uint32_t(1) << WAY_BITS;
// Cycles. Steps that are further apart are rare: with three arms, waiting for them takes a tenth of the time at most.
const uint16_t RARE = 4096;

uint32_t to_way(const Fine &value) { return uint32_t(value.high) << (WAY_BITS - 8) | value.low >> (40 - WAY_BITS); }

// From start to the first whole number on the way; nothing if it has just turned round between two.
uint32_t way_to_first(const Fine &start, int32_t before, bool forward) {
  if ((floor_steps(start) == before) == forward) return 0;
  return (forward ? -to_way(start) : to_way(start)) & (WAY_ONE - 1);
}

// 65536 * part / whole in whole numbers; at most 65535.
uint16_t fraction(uint32_t part, uint32_t whole) {
  if (part >= whole) return 0xFFFF;
  if (whole >= uint32_t(1) << 23) {
    whole >>= 8;
    part >>= 8;
  }
  uint24 rest = uint24(part);
  return places(&rest, uint24(whole));
}

uint16_t times(uint16_t fraction_of, uint16_t cycles) { return uint16_t(wide(fraction_of, cycles) >> 16); }

}  // namespace

bool make_train(const Axis &axis, int32_t before, uint16_t begin, Train *train) {
  int8_t steps = int8_t(axis.steps() - before);
  if (!steps) return false;
  bool forward = steps > 0;
  uint32_t way = to_way(axis.end()) - to_way(axis.start());
  if (!forward) way = -way;
  uint32_t first = way_to_first(axis.start(), before, forward);
  train->forward = forward;
  train->count = uint8_t(forward ? steps : -steps);
  if (train->count == 1) {
    // Settled arms have no way left: their last step is made at once.
    train->interval = 0;
    train->rare = true;
    train->first = uint16_t(begin + (way ? times(fraction(first, way), TICK_CYCLES) : 0));
  } else {
    train->interval = times(fraction(WAY_ONE, way), TICK_CYCLES);
    train->rare = train->interval >= RARE;
    train->first = uint16_t(begin + times(uint16_t(first >> (WAY_BITS - 16)), train->interval));
  }
  return true;
}

}  // namespace mega
}  // namespace beatrix
