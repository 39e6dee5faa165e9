// Tick of the planner.
//
// Timer 3 calls it every 16 000 cycles, with interrupts enabled, to plan the millisecond that starts 16 000 cycles
// after the tick was due. If a tick takes longer, all further ticks and steps are delayed, and none is lost. A tick
// takes about 2 000 cycles in addition to Machine::tick().
#include "../speed.h"
#include "tick.h"

#include <avr/interrupt.h>
#include <util/atomic.h>

#include "steps.h"
#include "step_times.h"

namespace beatrix {
namespace mega {

namespace {

const uint16_t PLAN_MARGIN = 64;  // cycles from reading the counter to queueing the first train
// Cycles between the milliseconds of two arms, so that arms at the same speed do not delay each other: the time of an
// interrupt for a sparse step and of the end of a tick.
const uint16_t STAGGER = 264;

Machine *machine;
volatile bool done_flag = false;
uint16_t begin = 0;  // of the last planned millisecond
Interval intervals[ARMS];

// The planned millisecond starts TICK_CYCLES after the last one, or later if that time has passed.
void start_millisecond() {
  begin = uint16_t(begin + TICK_CYCLES);
  ATOMIC_BLOCK(ATOMIC_FORCEON) {
    uint16_t soonest = uint16_t(now() + PLAN_MARGIN);
    if (int16_t(begin - soonest) < 0) {
      begin = soonest;
      OCR3A = uint16_t(TCNT3 + PLAN_MARGIN);
      TIFR3 = _BV(OCF3A);
    }
  }
}

void plan() {
  int32_t before[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) before[i] = machine->motion().axis(i).steps();
  machine->tick();
  start_millisecond();
  for (uint8_t i = 0; i < ARMS; i++) {
    StepTrain train;
    uint16_t first = uint16_t(begin + i * STAGGER);
    if (next_train(machine->motion().axis(i), before[i], first, &intervals[i], &train)) queue_train(i, train);
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

bool tick_done() { return done_flag; }
void clear_tick_done() { done_flag = false; }

}  // namespace mega

namespace hal {

void disable_tick() {
  TIMSK3 = 0;
  __asm__ volatile("" ::: "memory");
}

void enable_tick() {
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
  done_flag = true;
  cli();
  TIMSK3 = _BV(OCIE3A);
}
