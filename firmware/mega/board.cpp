// The board: start-up, main loop, watchdog.
#include "board.h"

#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "../core/machine.h"
#include "memory.h"
#include "serial.h"
#include "steps.h"
#include "tick.h"

namespace beatrix {

namespace {

Machine machine;

// What the Arduino core has started: its clock would take 3 % of the time, its PWM serves nobody here.
void stop_other_timers() {
  TIMSK0 = 0;
  TCCR0B = TCCR2B = TCCR4B = TCCR5B = 0;
  TCCR1A = TCCR1B = TCCR3A = TCCR3B = 0;
  ADCSRA = 0;
}

bool can_receive() { return mega::has_byte() && hal::room() >= REPLY_ROOM; }

// An interrupt between looking and sleeping would be slept through; the instruction after sei() still comes first.
void sleep_until_something_is_to_do() {
  cli();
  if (can_receive() || mega::tick_made()) {
    sei();
    return;
  }
  sei();
  sleep_cpu();
}

}  // namespace

void begin(uint32_t baud) {
  cli();
  stop_other_timers();
  SMCR = _BV(SE);  // sleep_cpu() means idle: timers and UART go on
  mega::start_steps();
  mega::count_start();
  mega::start_serial(baud);
  machine.start();
  mega::start_tick(machine);
  wdt_enable(WDTO_250MS);
  sei();
}

// What has come goes first: an EMERGENCY_STOP shall not wait for telemetry. But however much comes, poll() has its turn.
void run() {
  for (uint8_t i = 0; i < MAX_WIRE && can_receive(); i++) machine.receive(mega::take_byte());
  if (mega::tick_made()) {
    mega::forget_tick();
    machine.poll();
    mega::work_on_memory();
  }
  sleep_until_something_is_to_do();
}

namespace hal {
void kick_watchdog() { wdt_reset(); }
}  // namespace hal

}  // namespace beatrix

// After a reset by the watchdog it goes on running at its shortest period, 16 ms: it is stopped before anything else.
// Boot loaders do so too, but not all of them, and none is needed.
extern "C" void stop_watchdog() __attribute__((naked, used, section(".init3")));
extern "C" void stop_watchdog() {
  MCUSR = 0;
  wdt_disable();
}
