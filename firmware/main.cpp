// Program for `make mega`: the sketch without the Arduino core. This file is not in the sketch's folder, because
// the Arduino core has its own main().
#include "beatrix/beatrix.ino"

int main() {
  setup();
  for (;;) loop();
}
