// Products and proportions.
//
// Written for a processor that multiplies 8 bits: the compiler's own routines for 64 bits take three times as long.
#include "units.h"

namespace beatrix {

// From four products of 16 bits.
Fine product(uint32_t a, uint32_t b) {
  uint16_t a_low = uint16_t(a), a_high = uint16_t(a >> 16), b_low = uint16_t(b), b_high = uint16_t(b >> 16);
  uint32_t low = wide(a_low, b_low), one = wide(a_low, b_high), other = wide(a_high, b_low);
  uint32_t middle = (low >> 16) + uint16_t(one) + uint16_t(other);
  return Fine(int32_t(wide(a_high, b_high) + (one >> 16) + (other >> 16) + (middle >> 16)), middle << 16 | uint16_t(low));
}

uint16_t places(uint24 *rest, uint24 whole) {
  uint24 left = *rest;
  uint16_t result = 0;
  for (uint8_t i = 0; i < 16; i++) {
    left = uint24(left << 1);
    result = uint16_t(result << 1);
    if (left >= whole) {
      left = uint24(left - whole);
      __asm__("" : "+r"(left));  // keeps the branch: the compiler's way without it takes twice as long
      result++;
    }
  }
  *rest = left;
  return result;
}

uint64_t ratio_of(uint32_t part, uint32_t whole) {
  if (part == whole) return WHOLE;
  uint24 rest = uint24(part);
  uint32_t high = places(&rest, uint24(whole));
  return high << 16 | places(&rest, uint24(whole));
}

uint64_t rough_ratio_of(uint32_t part, uint32_t whole) {
  if (part == whole) return WHOLE;
  uint24 rest = uint24(part);
  return uint32_t(places(&rest, uint24(whole))) << 16;
}

Fine scaled(const Fine &value, uint64_t ratio) {
  if (ratio == WHOLE) return value;
  Fine result = product(middle(value), uint32_t(ratio));
  return Fine(result.high >> 16, middle(result));
}

}  // namespace beatrix
