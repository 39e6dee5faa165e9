// Step pulses.
//
// Timer 1 counts every cycle and is never reset. The channel of an idle arm matches every 4 ms; its interrupt then
// returns at once. So no flag needs to be cleared by software, which could lose the matches of other arms.
//
// A received byte, the tick or another arm can delay an interrupt by a hundred cycles. For sparse steps the match is
// therefore early, and the interrupt waits for the exact cycle. Dense steps do not wait, to save processor time.
#include "../speed.h"
#include "steps.h"

#include <avr/interrupt.h>
#include <util/atomic.h>

#include "../core/limits.h"
#include "../core/hal.h"
#include "pins.h"

namespace beatrix {
namespace mega {

namespace {

// Cycles from reading the counter to the earliest match that is not missed; also the shortest pause between pulses.
const uint16_t MATCH_LEAD = 32;
// Lead of the match before a sparse step: 60 cycles to the pin, and less than 100 for a byte or the end of a tick with
// interrupts disabled. Three arms that wait one after another delay the UART by 850 cycles. No byte is lost, because
// the UART holds two bytes of 640 cycles.
const uint8_t SPARSE_LEAD = 160;

struct Queue {
  uint8_t left;  // steps left of the current train
  bool sparse;
  bool forward;
  uint16_t interval;
  uint16_t due;  // time of the next step, for sparse trains
  StepTrain next;    // next.count is 0 if there is none
};

volatile Queue queues[ARMS];
int16_t discarded[ARMS];
bool drivers_on = false;

// Set the next match. Hides the origin of `late` from the compiler, which would otherwise save more registers.
template <uint8_t ARM>
inline __attribute__((always_inline)) void schedule(uint16_t when) {
  int16_t late = int16_t(TCNT1 + MATCH_LEAD - when);
  __asm__("" : "+r"(late));
  if (late >= 0) when = uint16_t(when + late);
  ArmPins<ARM>::match() = when;
}

// Wait exactly n + 9 cycles: each turn of the loop takes four, the last one three, and two bits select 0 to 3 more.
inline __attribute__((always_inline)) void wait_cycles(uint8_t n) {
  __asm__ volatile(
      "1: nop\n\t"
      "subi %0, 4\n\t"
      "brcc 1b\n\t"
      "sbrc %0, 0\n\t"  // 2 cycles if the bit is clear, with the jump 3
      "rjmp .+0\n\t"
      "sbrc %0, 1\n\t"
      "rjmp .+0\n\t"
      "sbrc %0, 1\n\t"
      "rjmp .+0"
      : "+d"(n));
}

// Wait until cycle `due` of Timer 1, unless it has passed.
inline __attribute__((always_inline)) void wait_for(uint16_t due) {
  int16_t left = int16_t(due - TCNT1);
  if (left < 0) left = 0;
  wait_cycles(uint8_t(left));
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void set_direction(bool forward) {
  queues[ARM].forward = forward;
  if (forward) {
    ArmPins<ARM>::forward();
  } else {
    ArmPins<ARM>::backward();
  }
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void schedule_early(uint16_t due) {
  queues[ARM].due = due;
  schedule<ARM>(uint16_t(due - SPARSE_LEAD));
}

// Set all fields of a train except the count: setting the count makes the train visible to the interrupt.
template <uint8_t ARM, typename Waiting>
inline __attribute__((always_inline)) void prepare(Waiting &train) {
  volatile Queue &queue = queues[ARM];
  set_direction<ARM>(train.forward);
  queue.interval = train.interval;
  bool sparse = train.sparse;
  queue.sparse = sparse;
  if (sparse) {
    schedule_early<ARM>(train.first);
  } else {
    schedule<ARM>(train.first);
  }
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void start_next() {
  volatile Queue &queue = queues[ARM];
  queue.left = queue.next.count;
  queue.next.count = 0;
  prepare<ARM>(queue.next);
}

// Make one step. The whole interrupt takes 90 cycles, or 140 if a train starts, and up to 140 more to wait for a sparse
// step. The pulse is at least 16 cycles (1 us) long.
template <uint8_t ARM>
inline __attribute__((always_inline)) void make_step() {
  volatile Queue &queue = queues[ARM];
  if (!queue.left) return;
  bool sparse = __builtin_expect(queue.sparse, false);
  if (sparse) wait_for(queue.due);
  ArmPins<ARM>::step_high();
  uint8_t left = uint8_t(queue.left - 1);
  queue.left = left;
  if (__builtin_expect(!left, false)) {
    if (queue.next.count) {
      start_next<ARM>();
    } else {
      __builtin_avr_delay_cycles(12);
    }
  } else if (sparse) {
    schedule_early<ARM>(uint16_t(queue.due + queue.interval));
  } else {
    schedule<ARM>(uint16_t(ArmPins<ARM>::match() + queue.interval));
  }
  ArmPins<ARM>::step_low();
}

// Start a train from rest; return whether it has started. It has not if a match of the idle channel is pending, because
// the interrupt of this match would make the first step; so this interrupt has to run first.
template <uint8_t ARM>
bool start_from_rest(const StepTrain &train) {
  volatile Queue &queue = queues[ARM];
  prepare<ARM>(train);
  if (TIFR1 & ArmPins<ARM>::FLAG) return false;
  queue.left = train.count;
  return true;
}

template <uint8_t ARM>
void queue_on(const StepTrain &train) {
  volatile Queue &queue = queues[ARM];
  for (bool done = false; !done;) {
    ATOMIC_BLOCK(ATOMIC_FORCEON) {
      if (!drivers_on) {
        done = true;
      } else if (queue.left) {
        queue.next.first = train.first;
        queue.next.interval = train.interval;
        queue.next.sparse = train.sparse;
        queue.next.forward = train.forward;
        queue.next.count = train.count;
        done = true;
      } else {
        done = start_from_rest<ARM>(train);
      }
    }
    __builtin_avr_nop();
  }
}

int16_t discard(volatile Queue &queue) {
  int16_t active = queue.forward ? queue.left : -queue.left;
  int16_t waiting = queue.next.forward ? queue.next.count : -queue.next.count;
  queue.left = queue.next.count = 0;
  return int16_t(active + waiting);
}

}  // namespace

void start_steps() {
  make_outputs();
  TCCR1A = 0;
  TCCR1B = _BV(CS10);
  TIMSK1 = _BV(OCIE1A) | _BV(OCIE1B) | _BV(OCIE1C);
}

uint16_t now() { return TCNT1; }

void queue_train(uint8_t arm, const StepTrain &train) {
  switch (arm) {
    case 0: return queue_on<0>(train);
    case 1: return queue_on<1>(train);
    default: return queue_on<2>(train);
  }
}

}  // namespace mega

namespace hal {

void set_drivers(bool on) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    if (on) {
      mega::set_enable_pin_on();
    } else {
      mega::set_enable_pin_off();
      for (uint8_t i = 0; i < ARMS; i++) mega::discarded[i] = mega::discard(mega::queues[i]);
    }
    mega::drivers_on = on;
  }
}

int16_t discarded_steps(uint8_t arm) {
  int16_t steps = mega::discarded[arm];
  mega::discarded[arm] = 0;
  return steps;
}

}  // namespace hal
}  // namespace beatrix

ISR(TIMER1_COMPA_vect) { beatrix::mega::make_step<0>(); }
ISR(TIMER1_COMPB_vect) { beatrix::mega::make_step<1>(); }
ISR(TIMER1_COMPC_vect) { beatrix::mega::make_step<2>(); }
