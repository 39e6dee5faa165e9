// BEATRIX for the Arduino IDE: open this file, choose the board "Arduino Mega or Mega 2560", upload.
#include "src/mega/board.h"

// Programs that drove BEATRIX in 2023 open the port at 9600 baud: for them write 9600 instead of beatrix::BAUD.
#ifndef BEATRIX_BAUD
#define BEATRIX_BAUD beatrix::BAUD
#endif

void setup() { beatrix::begin(BEATRIX_BAUD); }

void loop() { beatrix::run(); }
