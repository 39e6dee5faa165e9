// Step pulses.
//
// Timer 1 runs through, one cycle a count. A channel whose arm has nothing to do matches every 4 ms; its interrupt
// then finds nothing and ends. So no flag is ever cleared by hand, which would lose the matches of other arms in
// simulators and in read-modify-write mistakes alike.
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

struct Queue {
  uint8_t left;  // steps of the train being made
  uint16_t interval;
  bool forward;
  Train next;  // next.count 0: none
};

volatile Queue queues[ARMS];
int16_t thrown[ARMS];
bool powered = false;

inline bool before(uint16_t a, uint16_t b) { return int16_t(a - b) < 0; }

template <uint8_t ARM>
inline __attribute__((always_inline)) void schedule(uint16_t when) {
  uint16_t soon = uint16_t(TCNT1 + SOON);
  Wires<ARM>::match() = before(when, soon) ? soon : when;
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
inline __attribute__((always_inline)) void begin_next() {
  volatile Queue &queue = queues[ARM];
  turn<ARM>(queue.next.forward);
  queue.interval = queue.next.interval;
  queue.left = queue.next.count;
  queue.next.count = 0;
  schedule<ARM>(queue.next.first);
}

// The whole interrupt: about 110 cycles. A pulse of at least 16 cycles (1 us) lies between rise and fall.
template <uint8_t ARM>
inline __attribute__((always_inline)) void make_step() {
  volatile Queue &queue = queues[ARM];
  uint8_t left = queue.left;
  if (!left) return;
  Wires<ARM>::rise();
  queue.left = --left;
  if (left) {
    schedule<ARM>(uint16_t(Wires<ARM>::match() + queue.interval));
  } else if (queue.next.count) {
    begin_next<ARM>();
  } else {
    __builtin_avr_delay_cycles(12);
  }
  Wires<ARM>::fall();
}

// From rest. A match of the idle channel may be pending, and its interrupt must find nothing rather than the first step:
// so it is let in before the train begins. True: the train has begun.
template <uint8_t ARM>
bool begin_from_rest(const Train &train) {
  volatile Queue &queue = queues[ARM];
  turn<ARM>(train.forward);
  schedule<ARM>(train.first);
  if (TIFR1 & Wires<ARM>::FLAG) return false;
  queue.interval = train.interval;
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
