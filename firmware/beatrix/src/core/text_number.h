// Integers as decimal text.
#ifndef BEATRIX_TEXT_NUMBER_H
#define BEATRIX_TEXT_NUMBER_H

#include <stdint.h>

namespace beatrix {

static const uint8_t NUMBER_SIZE = 11;  // sign and ten digits

// Write `value` as decimal text; return the position after it.
inline char *write_number(int32_t value, char *out) {
  char digits[NUMBER_SIZE];
  uint8_t count = 0;
  uint32_t left = value < 0 ? -uint32_t(value) : uint32_t(value);
  do {
    digits[count++] = char('0' + left % 10);
    left /= 10;
  } while (left);
  if (value < 0) *out++ = '-';
  while (count) *out++ = digits[--count];
  return out;
}

}  // namespace beatrix

#endif
