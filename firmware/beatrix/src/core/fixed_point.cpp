// Products and ratios.
//
// Written for an 8-bit multiplier: the compiler's routines for 64 bits take three times as long.
#include "../speed.h"
#include "fixed_point.h"

namespace beatrix {

// Return a * b, computed from four products of 16 bits.
Fixed product(uint32_t a, uint32_t b) {
  uint16_t a_low = uint16_t(a), a_high = uint16_t(a >> 16), b_low = uint16_t(b), b_high = uint16_t(b >> 16);
  uint32_t low = multiply(a_low, b_low), one = multiply(a_low, b_high), other = multiply(a_high, b_low);
  uint32_t middle_bits = (low >> 16) + uint16_t(one) + uint16_t(other);
  uint32_t high = multiply(a_high, b_high) + (one >> 16) + (other >> 16) + (middle_bits >> 16);
  return Fixed(int32_t(high), middle_bits << 16 | uint16_t(low));
}

uint16_t quotient_bits(uint24 *rest, uint24 value) {
  uint24 left = *rest;
  uint16_t result = 0;
  for (uint8_t i = 0; i < 16; i++) {
    left = uint24(left << 1);
    result = uint16_t(result << 1);
    if (left >= value) {
      left = uint24(left - value);
      __asm__("" : "+r"(left));  // forces a branch: the branchless code of the compiler takes twice as long
      result++;
    }
  }
  *rest = left;
  return result;
}

uint64_t ratio(uint32_t part, uint32_t value) {
  if (part == value) return ONE;
  uint24 rest = uint24(part);
  uint32_t high = quotient_bits(&rest, uint24(value));
  return high << 16 | quotient_bits(&rest, uint24(value));
}

uint64_t rough_ratio(uint32_t part, uint32_t value) {
  if (part == value) return ONE;
  uint24 rest = uint24(part);
  return uint32_t(quotient_bits(&rest, uint24(value))) << 16;
}

Fixed scaled(const Fixed &value, uint64_t ratio) {
  if (ratio == ONE) return value;
  Fixed result = product(middle_bits(value), uint32_t(ratio));
  return Fixed(result.high >> 16, middle_bits(result));
}

}  // namespace beatrix
