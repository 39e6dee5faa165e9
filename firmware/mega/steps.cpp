// Step pulses.
//
// Timer 1 runs through, one cycle a count. A channel whose arm has nothing to do matches every 4 ms; its interrupt
// then finds nothing and ends. So no flag is ever cleared by hand, which would lose the matches of other arms in
// simulators and in read-modify-write mistakes alike.
//
// A byte on the wire, the tick or another arm can hold up an interrupt by a hundred cycles. Where steps are rare, the
// match therefore comes early and the interrupt waits for the very cycle. Where they are dense nothing is waited for: the
// processor has no time to spare.
#include "steps.h"

#include <avr/interrupt.h>
#include <util/atomic.h>

#include "../core/guard.h"
#include "../core/hal.h"
#include "pins.h"

namespace beatrix {
namespace mega {

namespace {

// From reading the counter to a match that is surely not missed; also the least pause between two pulses.
const uint16_t SOON = 32;
// How much earlier the match of a rare step is than its moment: the way to the pin takes 60 cycles, and what may go on
// before it, a byte or an end of the tick with interrupts off, less than 100. The wire bears it: three arms that wait one
// after another hold it up by 850 cycles; a byte takes 640 and the UART holds two.
const uint8_t EARLY = 160;

struct Queue {
  uint8_t left;  // steps of the train being made
  bool rare;
  bool forward;
  uint16_t interval;
  uint16_t due;  // the moment of the next step, where they are rare
  Train next;    // next.count 0: none
};

volatile Queue queues[ARMS];
int16_t thrown[ARMS];
bool powered = false;

// The compiler must not know what `late` is made of: it would keep both parts, and the interrupt save more registers.
template <uint8_t ARM>
inline __attribute__((always_inline)) void schedule(uint16_t when) {
  int16_t late = int16_t(TCNT1 + SOON - when);
  __asm__("" : "+r"(late));
  if (late >= 0) when = uint16_t(when + late);
  Wires<ARM>::match() = when;
}

// Exactly n + 9 cycles: a turn takes four, the last one three, and 0 to 3 are left in two bits.
inline __attribute__((always_inline)) void wait_cycles(uint8_t n) {
  __asm__ volatile(
      "1: nop\n\t"
      "subi %0, 4\n\t"
      "brcc 1b\n\t"
      "sbrc %0, 0\n\t"  // with its jump 2 cycles, or 3 if the bit is set
      "rjmp .+0\n\t"
      "sbrc %0, 1\n\t"
      "rjmp .+0\n\t"
      "sbrc %0, 1\n\t"
      "rjmp .+0"
      : "+d"(n));
}

// At once, if it has passed.
inline __attribute__((always_inline)) void wait_for(uint16_t due) {
  int16_t left = int16_t(due - TCNT1);
  if (left < 0) left = 0;
  wait_cycles(uint8_t(left));
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void turn(bool forward) {
  queues[ARM].forward = forward;
  if (forward) {
    Wires<ARM>::forward();
  } else {
    Wires<ARM>::backward();
  }
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void schedule_early(uint16_t due) {
  queues[ARM].due = due;
  schedule<ARM>(uint16_t(due - EARLY));
}

// All but the count, which makes the interrupt see the train.
template <uint8_t ARM, typename Waiting>
inline __attribute__((always_inline)) void prepare(Waiting &train) {
  volatile Queue &queue = queues[ARM];
  turn<ARM>(train.forward);
  queue.interval = train.interval;
  bool rare = train.rare;
  queue.rare = rare;
  if (rare) {
    schedule_early<ARM>(train.first);
  } else {
    schedule<ARM>(train.first);
  }
}

template <uint8_t ARM>
inline __attribute__((always_inline)) void begin_next() {
  volatile Queue &queue = queues[ARM];
  queue.left = queue.next.count;
  queue.next.count = 0;
  prepare<ARM>(queue.next);
}

// The whole interrupt: 90 cycles, 140 where a train begins, and before a rare step up to 140 of waiting. A pulse of at
// least 16 cycles (1 us) lies between rise and fall.
template <uint8_t ARM>
inline __attribute__((always_inline)) void make_step() {
  volatile Queue &queue = queues[ARM];
  if (!queue.left) return;
  bool rare = __builtin_expect(queue.rare, false);
  if (rare) wait_for(queue.due);
  Wires<ARM>::rise();
  uint8_t left = uint8_t(queue.left - 1);
  queue.left = left;
  if (__builtin_expect(!left, false)) {
    if (queue.next.count) {
      begin_next<ARM>();
    } else {
      __builtin_avr_delay_cycles(12);
    }
  } else if (rare) {
    schedule_early<ARM>(uint16_t(queue.due + queue.interval));
  } else {
    schedule<ARM>(uint16_t(Wires<ARM>::match() + queue.interval));
  }
  Wires<ARM>::fall();
}

// From rest. A match of the idle channel may be pending, and its interrupt must find nothing rather than the first step:
// so it is let in before the train begins. True: the train has begun.
template <uint8_t ARM>
bool begin_from_rest(const Train &train) {
  volatile Queue &queue = queues[ARM];
  prepare<ARM>(train);
  if (TIFR1 & Wires<ARM>::FLAG) return false;
  queue.left = train.count;
  return true;
}

template <uint8_t ARM>
void queue_for(const Train &train) {
  volatile Queue &queue = queues[ARM];
  for (bool done = false; !done;) {
    ATOMIC_BLOCK(ATOMIC_FORCEON) {
      if (!powered) {
        done = true;
      } else if (queue.left) {
        queue.next.first = train.first;
        queue.next.interval = train.interval;
        queue.next.rare = train.rare;
        queue.next.forward = train.forward;
        queue.next.count = train.count;
        done = true;
      } else {
        done = begin_from_rest<ARM>(train);
      }
    }
    __builtin_avr_nop();
  }
}

int16_t throw_away(volatile Queue &queue) {
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

void queue_train(uint8_t arm, const Train &train) {
  switch (arm) {
    case 0: return queue_for<0>(train);
    case 1: return queue_for<1>(train);
    default: return queue_for<2>(train);
  }
}

}  // namespace mega

namespace hal {

void drivers(bool on) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    if (on) {
      mega::enable_wire_on();
    } else {
      mega::enable_wire_off();
      for (uint8_t i = 0; i < ARMS; i++) mega::thrown[i] = mega::throw_away(mega::queues[i]);
    }
    mega::powered = on;
  }
}

int16_t unmade(uint8_t arm) {
  int16_t steps = mega::thrown[arm];
  mega::thrown[arm] = 0;
  return steps;
}

}  // namespace hal
}  // namespace beatrix

ISR(TIMER1_COMPA_vect) { beatrix::mega::make_step<0>(); }
ISR(TIMER1_COMPB_vect) { beatrix::mega::make_step<1>(); }
ISR(TIMER1_COMPC_vect) { beatrix::mega::make_step<2>(); }
