// What the core asks of the body it lives in, and what the body owes the core.
//
// The body owns one Machine and calls
//   machine.start()         once after reset, before interrupts are on;
//   machine.receive(byte)   from its main loop, for every byte that came, while room() >= REPLY_ROOM: replies are
//                           written at once and must never be dropped; bytes wait in the body's receive buffer;
//   machine.poll()          from its main loop, once per millisecond;
//   machine.tick()          every millisecond, from a timer interrupt; after it, motion().axis(i).start(), .end() and
//                           .steps() say where each arm's set point began and ended this millisecond (exact, Q40) and
//                           how many steps are made by its end. A step belongs to the moment the set point leaves the
//                           integer it came from, so a motion's first step stands at the begin of its first tick.
//                           steps() also changes in receive() (CALIBRATE), never the number of steps to make.
//
// Interrupts on the AVR, 16 000 cycles per millisecond, in order of their claims:
//   step (a compare match per arm)   at most 150 cycles: sets a pin, counts, loads the next compare time; no planning.
//                                    Up to 300 where steps are rare: it waits for their very cycle. Three of these in a
//                                    row still leave a byte its time: the UART holds two
//   receive, transmit (a byte)       at most 100 cycles: ring buffer only; at 250 000 baud a byte comes every 640
//   tick (1 kHz)                     at most 8 000 cycles, with interrupts on: plans one millisecond ahead of the steps
//   main loop                        the rest; a whole MOVE within 5 ms, of which at most 8 000 cycles hold the tick
#ifndef BEATRIX_HAL_H
#define BEATRIX_HAL_H

#include <stdint.h>

namespace beatrix {

static const uint8_t NAME_SIZE = 32;

namespace hal {

// Bytes that fit into the transmit buffer now; at least 128 when it is empty, for an answer in text and a reply beside it.
uint16_t room();
// Queue bytes; the core has looked at room().
void send(const uint8_t *bytes, uint8_t count);

// Motor drivers on or off. Off takes effect before it returns and throws away steps not made yet.
void drivers(bool on);
// How many steps of an arm the last drivers(false) threw away: forward minus backward.
int16_t unmade(uint8_t arm);

// How often the board was started, this time included.
uint32_t boot_number();
// Robot name in non-volatile memory, padded with zeros. Storing may take its time in the background.
void load_name(char name[NAME_SIZE]);
void store_name(const char name[NAME_SIZE]);

// Called from every poll().
void kick_watchdog();

// Keep tick() from running, and let it run again: masks the timer's interrupt, not those of bytes and steps; a tick
// that falls due in between comes late, not never. Also compiler barriers. Not nested.
void hold_tick();
void release_tick();

}  // namespace hal

class TickHeld {
 public:
  TickHeld() { hal::hold_tick(); }
  ~TickHeld() { hal::release_tick(); }

 private:
  TickHeld(const TickHeld &);
  TickHeld &operator=(const TickHeld &);
};

}  // namespace beatrix

#endif
