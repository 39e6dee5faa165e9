// Units of the planner: microsteps and microsteps per tick with 40 binary places, in 64 bits.
//
// The contract's 26 places are enough for an arm of its own. In a straight motion an arm with one step to do beside
// one with thousands has an acceleration of a few units of Q26, and rounding it would make the arms arrive at
// different times. 14 places more cost nothing and leave room for +-8 million microsteps (the guard ends at
// some thousands); 40 are whole bytes, which an AVR takes apart without shifting.
#ifndef BEATRIX_UNITS_H
#define BEATRIX_UNITS_H

#include <stdint.h>

namespace beatrix {

typedef int64_t Fine;  // Q40

static const uint8_t FINE_BITS = 40;
static const uint8_t FINE_OVER_Q26 = FINE_BITS - 26;

inline Fine to_fine(int32_t steps) { return Fine(uint64_t(uint32_t(steps) << (FINE_BITS - 32)) << 32); }
inline Fine from_q26(int64_t value) { return Fine(uint64_t(value) << FINE_OVER_Q26); }
inline int64_t to_q26(Fine value) { return value >> FINE_OVER_Q26; }

// In two shifts: compilers know how to take the upper half and its upper bytes.
inline int32_t floor_steps(Fine position) { return int32_t(position >> 32) >> (FINE_BITS - 32); }
inline int32_t ceil_steps(Fine position) { return floor_steps(position + ((Fine(1) << FINE_BITS) - 1)); }

// Quarter microsteps per second to microsteps per tick and back: 2^40 / 4000, and 4000 / 2^40 rounded.
inline Fine from_quarters(uint16_t speed) { return Fine(speed) * 274877907L; }
inline int32_t to_quarters(Fine speed) { return int32_t((speed * 125 + (Fine(1) << 34)) >> 35); }

}  // namespace beatrix

#endif
