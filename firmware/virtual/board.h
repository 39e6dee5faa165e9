// Virtual board: the C functions that WebAssembly exports.
#ifndef BEATRIX_VIRTUAL_BOARD_H
#define BEATRIX_VIRTUAL_BOARD_H

#include <stdint.h>

#ifdef __wasm__
#define EXPORT(name) extern "C" __attribute__((export_name(#name)))
#else
#define EXPORT(name) extern "C" __attribute__((visibility("default")))
#endif

// State of the board after the last call of start(), receive() or tick().
struct Report {
  int64_t start[3];  // set points, Q26 microsteps, at the start of the last tick
  int64_t end[3];    // and at its end
  int32_t steps[3];  // from home, as in TELEMETRY
  int32_t pulses[3]; // steps made since start, forward minus backward: not changed by CALIBRATE
  uint32_t drivers_on;
  uint32_t transmit_length;
  uint32_t waiting;  // 1: received bytes wait for room in the transmit buffer
};

// What the motors have received by the end of one tick.
struct Tick {
  int32_t pulses[3];  // as in Report
  uint32_t drivers_on;
};

// Return the robot name in non-volatile memory: 32 bytes; write it before start(), read it at any time.
EXPORT(name_buffer) char *name_buffer();
EXPORT(report_buffer) Report *report_buffer();
EXPORT(receive_buffer) uint8_t *receive_buffer();
EXPORT(receive_size) uint32_t receive_size();
EXPORT(transmit_buffer) uint8_t *transmit_buffer();
// The first 100 ticks of the last call of tick().
EXPORT(tick_buffer) Tick *tick_buffer();

// Reset the board. The caller counts its starts; this one has the number `boot_number`.
EXPORT(start) void start(uint32_t boot_number);

// Receive the first `length` bytes of the receive buffer and process them; return the number of bytes that fitted. If
// some did not, or report.waiting is set, drain, move the others to the front and call again. No byte is lost.
EXPORT(receive) uint32_t receive(uint32_t length);

// Advance time by ticks of one millisecond, and process waiting bytes after each.
EXPORT(tick) void tick(uint32_t milliseconds);

// Empty the transmit buffer, after the caller has read report.transmit_length bytes of it.
EXPORT(drain) void drain();

#endif
