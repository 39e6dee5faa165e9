// BEATRIX for the Arduino IDE: open this file, choose the board "Arduino Mega or Mega 2560", upload.
//
// The firmware itself is in beatrix_firmware.cpp beside this file, made from firmware/core and firmware/mega.
#include "beatrix_firmware.h"

// Programs that drove BEATRIX in 2023 open the port at 9600 baud: for them write 9600 instead of beatrix::BAUD.
void setup() { beatrix::begin(beatrix::BAUD); }

void loop() { beatrix::run(); }
