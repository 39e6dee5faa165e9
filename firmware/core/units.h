// Units of the planner: microsteps and microsteps per tick with 42 binary places, in 64 bits.
//
// The contract's 26 places are enough for an arm of its own. In a straight motion an arm with one step to do beside
// one with thousands has an acceleration of a few units of Q26, and rounding it would make the arms arrive at
// different times; 16 places more cost nothing and leave room for +-2 million microsteps (the guard ends at
// some thousands).
#ifndef BEATRIX_UNITS_H
#define BEATRIX_UNITS_H

#include <stdint.h>

namespace beatrix {

typedef int64_t Fine;  // Q42

static const uint8_t FINE_BITS = 42;
static const uint8_t FINE_OVER_Q26 = FINE_BITS - 26;

inline Fine to_fine(int32_t steps) { return Fine(uint64_t(int64_t(steps)) << FINE_BITS); }
inline Fine from_q26(int64_t value) { return Fine(uint64_t(value) << FINE_OVER_Q26); }
inline int64_t to_q26(Fine value) { return value >> FINE_OVER_Q26; }

inline int32_t floor_steps(Fine position) { return int32_t(position >> FINE_BITS); }
inline int32_t ceil_steps(Fine position) { return -floor_steps(-position); }

// Quarter microsteps per second to microsteps per tick and back: 2^42 / 4000, and 4000 / 2^42 rounded.
inline Fine from_quarters(uint16_t speed) { return Fine(speed) * 1099511628L; }
inline int32_t to_quarters(Fine speed) { return int32_t((speed * 125 + (Fine(1) << 36)) >> 37); }

}  // namespace beatrix

#endif
