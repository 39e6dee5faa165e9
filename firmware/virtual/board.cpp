// Target of the virtual board: the firmware as a library, for WebAssembly and for the host.
//
// It has no imports. Only tick() advances time; receive() processes bytes at once, and replies are ready when it
// returns. A copy of the library's memory is a copy of the board.
#include "board.h"

#include "../beatrix/src/core/machine.h"

using beatrix::ARMS;
using beatrix::NAME_SIZE;

namespace {

const uint16_t RECEIVE_SIZE = 256;
const uint16_t TRANSMIT_SIZE = 16384;  // three seconds of telemetry
const uint32_t TICKS_SIZE = 100;

beatrix::Machine machine;
beatrix::ReceiveBuffer waiting_bytes;
Report report;
uint32_t boot;
char stored_name[NAME_SIZE];
uint8_t received[RECEIVE_SIZE];
uint8_t transmitted[TRANSMIT_SIZE];
Tick ticks[TICKS_SIZE];

void update_report() {
  for (uint8_t i = 0; i < ARMS; i++) {
    const beatrix::Axis &axis = machine.motion().axis(i);
    report.start[i] = beatrix::to_q26(axis.start());
    report.end[i] = beatrix::to_q26(axis.end());
    report.steps[i] = axis.steps();
  }
  report.waiting = !waiting_bytes.empty() || waiting_bytes.stop_is_due();
}

}  // namespace

namespace beatrix {
namespace hal {

uint16_t transmit_room() { return uint16_t(TRANSMIT_SIZE - report.transmit_length); }

void send(const uint8_t *bytes, uint8_t count) {
  for (uint8_t i = 0; i < count; i++) transmitted[report.transmit_length++] = bytes[i];
}

void set_drivers(bool on) { report.drivers_on = on; }
int16_t discarded_steps(uint8_t) { return 0; }

uint32_t boot_number() { return boot; }
void load_name(char name[NAME_SIZE]) {
  for (uint8_t i = 0; i < NAME_SIZE; i++) name[i] = stored_name[i];
}
void store_name(const char name[NAME_SIZE]) {
  for (uint8_t i = 0; i < NAME_SIZE; i++) stored_name[i] = name[i];
}
uint8_t bytes_lost() { return waiting_bytes.bytes_lost(); }
void reset_watchdog() {}
void disable_tick() {}
void enable_tick() {}

}  // namespace hal
}  // namespace beatrix

char *name_buffer() { return stored_name; }
Report *report_buffer() { return &report; }
uint8_t *receive_buffer() { return received; }
uint32_t receive_size() { return RECEIVE_SIZE; }
uint8_t *transmit_buffer() { return transmitted; }
Tick *tick_buffer() { return ticks; }

void start(uint32_t boot_number) {
  boot = boot_number;
  machine = beatrix::Machine();
  waiting_bytes = beatrix::ReceiveBuffer();
  report = Report();
  machine.start();
  machine.poll();
  update_report();
}

uint32_t receive(uint32_t length) {
  uint32_t done = 0;
  while (done < length && !waiting_bytes.full()) waiting_bytes.put(received[done++]);
  machine.process(waiting_bytes, 255);
  machine.poll();
  update_report();
  return done;
}

void tick(uint32_t milliseconds) {
  for (uint32_t done = 0; done < milliseconds; done++) {
    int32_t before[ARMS];
    for (uint8_t i = 0; i < ARMS; i++) before[i] = machine.motion().axis(i).steps();
    machine.tick();
    for (uint8_t i = 0; i < ARMS; i++) report.pulses[i] += machine.motion().axis(i).steps() - before[i];
    machine.process(waiting_bytes, 255);
    machine.poll();
    if (done < TICKS_SIZE) {
      for (uint8_t i = 0; i < ARMS; i++) ticks[done].pulses[i] = report.pulses[i];
      ticks[done].drivers_on = report.drivers_on;
    }
  }
  update_report();
}

void drain() { report.transmit_length = 0; }
