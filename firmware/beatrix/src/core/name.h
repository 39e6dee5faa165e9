// Robot names.
#ifndef BEATRIX_NAME_H
#define BEATRIX_NAME_H

#include "hal.h"

namespace beatrix {

// Return whether a name matches [a-z0-9-]{1,32} and is padded with zeros.
inline bool valid_name(const char name[NAME_SIZE]) {
  uint8_t length = 0;
  while (length < NAME_SIZE && name[length]) {
    char c = name[length++];
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-')) return false;
  }
  for (uint8_t i = length; i < NAME_SIZE; i++) {
    if (name[i]) return false;
  }
  return length > 0;
}

}  // namespace beatrix

#endif
