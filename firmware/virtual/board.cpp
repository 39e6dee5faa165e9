// The body of the virtual board: the firmware as a library, for WebAssembly and for the host.
//
// Nothing is imported. Time passes in tick() only, bytes are processed as they come, replies are ready on return.
// All state is in this library's memory: a copy of the memory is a copy of the board.
#include "board.h"

#include "../core/machine.h"

using beatrix::ARMS;
using beatrix::NAME_SIZE;

namespace {

const uint16_t RECEIVE_SIZE = 256;
const uint16_t TRANSMIT_SIZE = 16384;  // three seconds of telemetry

beatrix::Machine machine;
Report report;
uint32_t boot;
char stored_name[NAME_SIZE];
uint8_t received[RECEIVE_SIZE];
uint8_t transmitted[TRANSMIT_SIZE];

void look() {
  for (uint8_t i = 0; i < ARMS; i++) {
    const beatrix::Axis &axis = machine.motion().axis(i);
    report.start[i] = beatrix::to_q26(axis.start());
    report.end[i] = beatrix::to_q26(axis.end());
    report.steps[i] = axis.steps();
  }
}

}  // namespace

namespace beatrix {
namespace hal {

uint16_t room() { return uint16_t(TRANSMIT_SIZE - report.transmit_length); }

void send(const uint8_t *bytes, uint8_t count) {
  for (uint8_t i = 0; i < count; i++) transmitted[report.transmit_length++] = bytes[i];
}

void drivers(bool on) { report.drivers_on = on; }
int16_t unmade(uint8_t) { return 0; }

uint32_t boot_number() { return boot; }
void load_name(char name[NAME_SIZE]) {
  for (uint8_t i = 0; i < NAME_SIZE; i++) name[i] = stored_name[i];
}
void store_name(const char name[NAME_SIZE]) {
  for (uint8_t i = 0; i < NAME_SIZE; i++) stored_name[i] = name[i];
}
void kick_watchdog() {}
void hold_tick() {}
void release_tick() {}

}  // namespace hal
}  // namespace beatrix

char *name_buffer() { return stored_name; }
Report *report_buffer() { return &report; }
uint8_t *receive_buffer() { return received; }
uint32_t receive_size() { return RECEIVE_SIZE; }
uint8_t *transmit_buffer() { return transmitted; }

void start(uint32_t boot_number) {
  boot = boot_number;
  machine = beatrix::Machine();
  report = Report();
  machine.start();
  machine.poll();
  look();
}

uint32_t receive(uint32_t length) {
  uint32_t done = 0;
  while (done < length && beatrix::hal::room() >= beatrix::REPLY_ROOM) machine.receive(received[done++]);
  machine.poll();
  look();
  return done;
}

void tick(uint32_t milliseconds) {
  while (milliseconds--) {
    int32_t before[ARMS];
    for (uint8_t i = 0; i < ARMS; i++) before[i] = machine.motion().axis(i).steps();
    machine.tick();
    for (uint8_t i = 0; i < ARMS; i++) report.pulses[i] += machine.motion().axis(i).steps() - before[i];
    machine.poll();
  }
  look();
}

void drain() { report.transmit_length = 0; }
