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

static const uint8_t FINE_BITS = 40;
static const uint8_t FINE_OVER_Q26 = FINE_BITS - 26;

// In two halves: the AVR's compiler keeps 32 bits in registers, but calls a subroutine for every sum and every
// comparison of 64. A tick of three arms takes half as long.
struct Fine {
  uint32_t low;
  int32_t high;  // Q8

  // constexpr: a board is constant from the start. WebAssembly would run its constructor before every call.
  constexpr Fine() : low(0), high(0) {}
  constexpr Fine(int32_t high_half, uint32_t low_half) : low(low_half), high(high_half) {}
  constexpr explicit Fine(int64_t value) : low(uint32_t(value)), high(int32_t(value >> 32)) {}
  // Copied half by half as well: the compiler would copy byte by byte, in a loop.
  constexpr Fine(const Fine &other) : low(other.low), high(other.high) {}
  Fine &operator=(const Fine &other) {
    low = other.low;
    high = other.high;
    return *this;
  }
  // For products and quotients.
  int64_t whole() const { return int64_t(uint64_t(uint32_t(high)) << 32 | low); }
};

// Sums wrap as unsigned numbers do: no input can make them undefined.
inline Fine operator+(const Fine &a, const Fine &b) {
  uint32_t low = a.low + b.low;
  uint32_t high = uint32_t(a.high) + uint32_t(b.high);
  if (low < b.low) high++;
  return Fine(int32_t(high), low);
}

inline Fine operator-(const Fine &a, const Fine &b) {
  uint32_t high = uint32_t(a.high) - uint32_t(b.high);
  if (a.low < b.low) high--;
  return Fine(int32_t(high), a.low - b.low);
}

inline Fine operator-(const Fine &a) { return Fine() - a; }
// The compiler must not know that a factor is used twice: it would widen it once, and then multiply 32 bits by 32.
inline uint32_t wide(uint16_t a, uint16_t b) {
  __asm__("" : "+r"(a), "+r"(b));
  return uint32_t(a) * b;
}

// Of values from 0 to less than 256.
inline Fine operator*(const Fine &a, uint16_t n) {
  uint32_t middle = wide(uint16_t(a.low >> 16), n);
  uint32_t high = wide(uint16_t(a.high), n) + (middle >> 16);
  uint32_t low = wide(uint16_t(a.low), n);
  middle <<= 16;
  low += middle;
  if (low < middle) high++;
  return Fine(int32_t(high), low);
}

Fine product(uint32_t a, uint32_t b);
inline Fine half(const Fine &a) { return Fine(a.high >> 1, uint32_t(a.high) << 31 | a.low >> 1); }
// a / 65536 in 32 bits.
inline uint32_t middle(const Fine &a) { return uint32_t(a.high) << 16 | a.low >> 16; }
inline bool operator==(const Fine &a, const Fine &b) { return a.low == b.low && a.high == b.high; }
inline bool operator!=(const Fine &a, const Fine &b) { return !(a == b); }
inline bool operator<(const Fine &a, const Fine &b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}
inline bool operator>(const Fine &a, const Fine &b) { return b < a; }
inline bool operator<=(const Fine &a, const Fine &b) { return !(b < a); }
inline bool operator>=(const Fine &a, const Fine &b) { return !(a < b); }

inline Fine to_fine(int32_t steps) { return Fine(int32_t(uint32_t(steps) << (FINE_BITS - 32)), 0); }
inline Fine from_q26(int32_t value) { return Fine(value >> (32 - FINE_OVER_Q26), uint32_t(value) << FINE_OVER_Q26); }
inline int64_t to_q26(const Fine &value) { return value.whole() >> FINE_OVER_Q26; }
// Of values from 0 to less than 64.
inline uint32_t to_small_q26(const Fine &value) {
  Fine twice = value + value;
  return middle(twice + twice);
}

inline int32_t floor_steps(const Fine &position) { return position.high >> (FINE_BITS - 32); }
inline bool is_whole(const Fine &position) { return position.low == 0 && uint8_t(position.high) == 0; }
inline int32_t ceil_steps(const Fine &position) { return floor_steps(position) + (is_whole(position) ? 0 : 1); }

// Quarter microsteps per second to microsteps per tick, 2^40 / 4000; and to microsteps per second, 1000 / 2^40 rounded.
inline Fine from_quarters(uint16_t speed) { return Fine(0, 274877907) * speed; }
inline int16_t to_rate(const Fine &speed) { return int16_t(Fine(speed.whole() * 125 + (int64_t(1) << 36)).high >> 5); }

// Proportions: 32 binary places, from 0 to WHOLE.
static const uint64_t WHOLE = uint64_t(1) << 32;
// part / whole, part <= whole < 2^23.
uint64_t ratio_of(uint32_t part, uint32_t whole);
uint64_t rough_ratio_of(uint32_t part, uint32_t whole);  // 16 places of it, in half the time
// The first 16 binary places of rest / whole, rest < whole < 2^23, and for the next ones what is left.
#ifdef __AVR__
typedef __uint24 uint24;  // a third faster than 32 bits
#else
typedef uint32_t uint24;
#endif
uint16_t places(uint24 *rest, uint24 whole);
// Of values from 0 to less than 65536.
Fine scaled(const Fine &value, uint64_t ratio);

}  // namespace beatrix

#endif
