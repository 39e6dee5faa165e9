// The planner's tick.
//
// Timer 3 calls it every 16 000 cycles, with interrupts on, to plan the millisecond that begins 16 000 cycles after it
// was due. Should it ever be ready later than that, time is stretched: all further ticks and steps come later, none is
// lost. Cost: about 2 000 cycles beside Machine::tick().
#include "tick.h"

#include <avr/interrupt.h>
#include <util/atomic.h>

#include "steps.h"
#include "timing.h"

namespace beatrix {
namespace mega {

namespace {

const uint16_t SPARE = 64;  // from looking at the clock to the first train's queueing
// Each arm's millisecond begins so much later than that of the arm before, so that arms that go alike do not hold each
// other up: a rare step's interrupt, and the end of a tick behind it.
const uint16_t STAGGER = 264;

Machine *machine;
volatile bool made = false;
uint16_t begin = 0;  // of the millisecond planned last

// The planned millisecond begins TICK_CYCLES after the last one, or later if that is no longer possible.
void begin_millisecond() {
  begin = uint16_t(begin + TICK_CYCLES);
  ATOMIC_BLOCK(ATOMIC_FORCEON) {
    uint16_t soonest = uint16_t(now() + SPARE);
    if (int16_t(begin - soonest) < 0) {
      begin = soonest;
      OCR3A = uint16_t(TCNT3 + SPARE);
      TIFR3 = _BV(OCF3A);
    }
  }
}

void plan() {
  int32_t before[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) before[i] = machine->motion().axis(i).steps();
  machine->tick();
  begin_millisecond();
  for (uint8_t i = 0; i < ARMS; i++) {
    Train train;
    if (make_train(machine->motion().axis(i), before[i], uint16_t(begin + i * STAGGER), &train)) queue_train(i, train);
  }
}

}  // namespace

void start_tick(Machine &board) {
  machine = &board;
  TCCR3A = 0;
  OCR3A = TICK_CYCLES;
  TCCR3B = _BV(CS30);
  begin = uint16_t(now() + TICK_CYCLES);
  TIMSK3 = _BV(OCIE3A);
}

bool tick_made() { return made; }
void forget_tick() { made = false; }

}  // namespace mega

namespace hal {

void hold_tick() {
  TIMSK3 = 0;
  __asm__ volatile("" ::: "memory");
}

void release_tick() {
  __asm__ volatile("" ::: "memory");
  TIMSK3 = _BV(OCIE3A);
}

}  // namespace hal
}  // namespace beatrix

ISR(TIMER3_COMPA_vect) {
  using namespace beatrix::mega;
  OCR3A = uint16_t(OCR3A + beatrix::mega::TICK_CYCLES);
  TIMSK3 = 0;
  sei();
  plan();
  made = true;
  cli();
  TIMSK3 = _BV(OCIE3A);
}
