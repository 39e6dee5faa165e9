// Fixed-point numbers of the planner: microsteps and microsteps per tick with 40 fractional bits, in 64 bits.
//
// The 26 bits of the contract are enough for a single arm. In a straight motion, an arm that makes one step while
// another makes thousands has an acceleration of a few units of Q26, and rounding would make the arms arrive at
// different times. 14 more bits cost nothing and allow +-8 million microsteps (the limits are a few thousand). 40 bits
// are whole bytes, which an AVR separates without shifts.
#ifndef BEATRIX_FIXED_POINT_H
#define BEATRIX_FIXED_POINT_H

#include <stdint.h>

namespace beatrix {

static const uint8_t FRACTION_BITS = 40;
static const uint8_t BITS_BEYOND_Q26 = FRACTION_BITS - 26;

// A 64-bit fixed-point number in two 32-bit halves. avr-gcc keeps 32-bit values in registers, but calls a subroutine
// for each 64-bit addition and comparison: the halves halve the time of a tick.
struct Fixed {
  uint32_t low;
  int32_t high;  // Q8

  // constexpr: avoids a start-up constructor, which WebAssembly would run before every call.
  constexpr Fixed() : low(0), high(0) {}
  constexpr Fixed(int32_t high_half, uint32_t low_half) : low(low_half), high(high_half) {}
  constexpr explicit Fixed(int64_t value) : low(uint32_t(value)), high(int32_t(value >> 32)) {}
  // Copies the two halves, because the default copy loops over the bytes.
  constexpr Fixed(const Fixed &other) : low(other.low), high(other.high) {}
  Fixed &operator=(const Fixed &other) {
    low = other.low;
    high = other.high;
    return *this;
  }
  // Return the two halves as one number, for products and quotients.
  int64_t value() const { return int64_t(uint64_t(uint32_t(high)) << 32 | low); }
};

// Sums wrap like unsigned numbers, so no input causes undefined behaviour.
inline Fixed operator+(const Fixed &a, const Fixed &b) {
  uint32_t low = a.low + b.low;
  uint32_t high = uint32_t(a.high) + uint32_t(b.high);
  if (low < b.low) high++;
  return Fixed(int32_t(high), low);
}

inline Fixed operator-(const Fixed &a, const Fixed &b) {
  uint32_t high = uint32_t(a.high) - uint32_t(b.high);
  if (a.low < b.low) high--;
  return Fixed(int32_t(high), a.low - b.low);
}

inline Fixed operator-(const Fixed &a) { return Fixed() - a; }
// Return a * b. Hides the factors from the compiler, which would otherwise widen a repeated factor to 32 bits.
inline uint32_t multiply(uint16_t a, uint16_t b) {
  __asm__("" : "+r"(a), "+r"(b));
  return uint32_t(a) * b;
}

// Return a * n, for `a` from 0 to less than 256.
inline Fixed operator*(const Fixed &a, uint16_t n) {
  uint32_t middle_bits = multiply(uint16_t(a.low >> 16), n);
  uint32_t high = multiply(uint16_t(a.high), n) + (middle_bits >> 16);
  uint32_t low = multiply(uint16_t(a.low), n);
  middle_bits <<= 16;
  low += middle_bits;
  if (low < middle_bits) high++;
  return Fixed(int32_t(high), low);
}

Fixed product(uint32_t a, uint32_t b);
inline Fixed half(const Fixed &a) { return Fixed(a.high >> 1, uint32_t(a.high) << 31 | a.low >> 1); }
// Return bits 16 to 47 of `a`.
inline uint32_t middle_bits(const Fixed &a) { return uint32_t(a.high) << 16 | a.low >> 16; }
inline bool operator==(const Fixed &a, const Fixed &b) { return a.low == b.low && a.high == b.high; }
inline bool operator!=(const Fixed &a, const Fixed &b) { return !(a == b); }
inline bool operator<(const Fixed &a, const Fixed &b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}
inline bool operator>(const Fixed &a, const Fixed &b) { return b < a; }
inline bool operator<=(const Fixed &a, const Fixed &b) { return !(b < a); }
inline bool operator>=(const Fixed &a, const Fixed &b) { return !(a < b); }

inline Fixed to_fixed(int32_t steps) { return Fixed(int32_t(uint32_t(steps) << (FRACTION_BITS - 32)), 0); }
inline Fixed from_q26(int32_t value) { return Fixed(value >> (32 - BITS_BEYOND_Q26), uint32_t(value) << BITS_BEYOND_Q26); }
inline int64_t to_q26(const Fixed &value) { return value.value() >> BITS_BEYOND_Q26; }

inline int32_t floor_steps(const Fixed &position) { return position.high >> (FRACTION_BITS - 32); }
inline bool is_integer(const Fixed &position) { return position.low == 0 && uint8_t(position.high) == 0; }
inline int32_t ceil_steps(const Fixed &position) { return floor_steps(position) + (is_integer(position) ? 0 : 1); }

// Convert quarter microsteps per second to microsteps per tick (times 2^40 / 4000), and microsteps per tick to
// microsteps per second (times 1000 / 2^40, rounded).
inline Fixed from_quarters(uint16_t speed) { return Fixed(0, 274877907) * speed; }
inline int16_t to_rate(const Fixed &speed) { return int16_t(Fixed(speed.value() * 125 + (int64_t(1) << 36)).high >> 5); }

// Ratios: 32 fractional bits, from 0 to ONE.
static const uint64_t ONE = uint64_t(1) << 32;
// Return part / value, for part <= value < 2^23.
uint64_t ratio(uint32_t part, uint32_t value);
uint64_t rough_ratio(uint32_t part, uint32_t value);  // the first 16 bits of ratio(), in half the time
// Return the first 16 fractional bits of *rest / value, for *rest < value < 2^23; *rest becomes the remainder.
#ifdef __AVR__
typedef __uint24 uint24;  // a third faster than 32 bits
#else
typedef uint32_t uint24;
#endif
uint16_t quotient_bits(uint24 *rest, uint24 value);
// Return value * ratio, for values from 0 to less than 128.
Fixed scaled(const Fixed &value, uint64_t ratio);

}  // namespace beatrix

#endif
