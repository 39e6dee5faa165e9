// Products and proportions.
//
// Written for a processor that multiplies 8 bits: the compiler's own routines for 64 bits take three times as long.
#include "units.h"

namespace beatrix {

// From four products of 16 bits.
Fine product(uint32_t a, uint32_t b) {
  uint16_t a_low = uint16_t(a), a_high = uint16_t(a >> 16), b_low = uint16_t(b), b_high = uint16_t(b >> 16);
  uint32_t low = uint32_t(a_low) * b_low, high = uint32_t(a_high) * b_high;
  uint32_t one = uint32_t(a_low) * b_high, other = uint32_t(a_high) * b_low;
  uint32_t middle = (low >> 16) + uint16_t(one) + uint16_t(other);
  return Fine(int32_t(high + (one >> 16) + (other >> 16) + (middle >> 16)), middle << 16 | uint16_t(low));
}

Fine operator*(const Fine &a, uint32_t n) {
  Fine whole = product(a.low, n);
  whole.high = int32_t(uint32_t(whole.high) + uint32_t(a.high) * n);
  return whole;
}

// In two divisions of 32 bits; ways of more than 65535 steps need one of 64, which takes an AVR five times as long.
uint64_t ratio_of(uint32_t part, uint32_t whole) {
  if (part == whole) return WHOLE;
  if (whole > 0xFFFF) return (uint64_t(part) << 32) / whole;
  uint32_t rest = (part << 16) % whole;
  return (part << 16) / whole << 16 | (rest << 16) / whole;
}

Fine scaled(const Fine &value, uint64_t ratio) {
  if (ratio == WHOLE) return value;
  Fine result = product(middle(value), uint32_t(ratio));
  return Fine(result.high >> 16, middle(result));
}

}  // namespace beatrix
