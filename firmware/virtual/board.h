// The virtual board as a library: the C functions that WebAssembly and the host library export.
#ifndef BEATRIX_VIRTUAL_BOARD_H
#define BEATRIX_VIRTUAL_BOARD_H

#include <stdint.h>

#ifdef __wasm__
#define EXPORT(name) extern "C" __attribute__((export_name(#name)))
#else
#define EXPORT(name) extern "C" __attribute__((visibility("default")))
#endif

// What a caller wants to see after every call.
struct Report {
  int64_t start[3];  // set points, Q26 microsteps, at the last tick's begin
  int64_t end[3];    // and end
  int32_t steps[3];  // from home, as in TELEMETRY
  int32_t pulses[3]; // given to the motors since start, forward minus backward: not changed by CALIBRATE
  uint32_t drivers_on;
  uint32_t transmit_length;
};

// Robot name in non-volatile memory: 32 bytes, to be written before start() and read at any time.
EXPORT(name_buffer) char *name_buffer();
EXPORT(report_buffer) Report *report_buffer();
EXPORT(receive_buffer) uint8_t *receive_buffer();
EXPORT(receive_size) uint32_t receive_size();
EXPORT(transmit_buffer) uint8_t *transmit_buffer();

// A reset. The boot number comes from outside: it counts the starts of what this board stands for.
EXPORT(start) void start(uint32_t boot_number);

// Processes the first `length` bytes of the receive buffer; returns how many. Fewer means: drain, move the others to
// the front and call again, because the transmit buffer had no room for another reply.
EXPORT(receive) uint32_t receive(uint32_t length);

// Lets that many milliseconds pass.
EXPORT(tick) void tick(uint32_t milliseconds);

// The transmit buffer has been read: report.transmit_length bytes of it.
EXPORT(drain) void drain();

#endif
