// The board: start-up, main loop, watchdog.
#include "../speed.h"
#include "board.h"

#include <avr/interrupt.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "../core/machine.h"
#include "eeprom.h"
#include "serial.h"
#include "steps.h"
#include "tick.h"

namespace beatrix {

namespace {

Machine machine;

// Stop what the Arduino core has started: its clock, which would take 3 % of the processor time, timers, and the ADC.
void stop_other_timers() {
  TIMSK0 = 0;
  TCCR0B = TCCR2B = TCCR4B = TCCR5B = 0;
  TCCR1A = TCCR1B = TCCR3A = TCCR3B = 0;
  ADCSRA = 0;
}

// Return whether received bytes can be processed. Every motor step wakes the processor, so quick checks come first.
inline bool work_pending() {
  const ReceiveBuffer &buffer = mega::receive_buffer;
  if (buffer.has_unscanned()) return true;
  return (!buffer.empty() || buffer.stop_is_due()) && hal::transmit_room() >= REPLY_ROOM;
}

// Sleep until an interrupt, unless there is work. No interrupt is missed: they are disabled during the check, and after
// sei() the processor executes sleep_cpu() before it handles one.
void sleep_until_interrupt() {
  cli();
  if (work_pending() || mega::tick_done()) {
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
  SMCR = _BV(SE);  // sleep mode idle: timers and UART continue
  mega::start_steps();
  mega::count_boot();
  mega::start_serial(baud);
  machine.start();
  mega::start_tick(machine);
  wdt_enable(WDTO_250MS);
  sei();
}

// Process received bytes before telemetry, because they may contain EMERGENCY_STOP, but at most MAX_WIRE of them, so
// that poll() runs even while bytes arrive without a pause.
void run() {
  if (work_pending()) machine.process(mega::receive_buffer, MAX_WIRE);
  if (mega::tick_done()) {
    mega::clear_tick_done();
    machine.poll();
    mega::continue_eeprom_write();
  }
  sleep_until_interrupt();
}

namespace hal {
void reset_watchdog() { wdt_reset(); }
}  // namespace hal

}  // namespace beatrix

// After a watchdog reset the watchdog keeps running with its shortest period, 16 ms, so it is stopped first. Most boot
// loaders stop it as well, but the firmware also runs without a boot loader.
extern "C" void stop_watchdog() __attribute__((naked, used, section(".init3")));
extern "C" void stop_watchdog() {
  MCUSR = 0;
  wdt_disable();
}
