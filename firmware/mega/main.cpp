// The firmware without the Arduino core.
#include "board.h"

#ifndef BEATRIX_BAUD
#define BEATRIX_BAUD beatrix::BAUD
#endif

int main() {
  beatrix::begin(BEATRIX_BAUD);
  for (;;) beatrix::run();
}
