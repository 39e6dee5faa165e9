// Interface between the portable core and a target (src/mega, firmware/virtual).
//
// The target owns one Machine and calls
//   machine.start()         once after reset, before interrupts are on;
//   buffer.put(byte)        for every received byte, from the receive interrupt;
//   machine.process(buffer, n)  from its main loop: carries out received STOP and EMERGENCY_STOP frames, even behind
//                           other bytes, then decodes up to n bytes while transmit_room() >= REPLY_ROOM. Replies are
//                           never dropped: without room for one, the received bytes wait;
//   machine.poll()          from its main loop, once per millisecond;
//   machine.tick()          every millisecond, from a timer interrupt. Then motion().axis(i).start() and .end() are
//                           the exact set points (Q40) at the start and end of this millisecond, .steps() the steps due
//                           by its end. A step is due when the set point leaves the integer it came from, so the first
//                           step of a motion is due at the start of its first tick. process() also changes steps()
//                           (CALIBRATE), but never the number of steps to make.
//
// Interrupts on the AVR, 16 000 cycles per millisecond, by priority:
//   step (a compare match per arm)   at most 150 cycles: sets a pin, counts, loads the next compare time; no planning.
//                                    Up to 300 for a sparse step, because it waits for the exact cycle. The UART holds
//                                    two bytes, so no byte is lost if three of these interrupts follow one another
//   receive, transmit (a byte)       at most 100 cycles: ring buffer only; a byte comes every 640 cycles (250 000 baud)
//   tick (1 kHz)                     at most 8 000 cycles, with interrupts on: plans one millisecond ahead of the steps
//   main loop                        the rest; one action, a MOVE or a line of text, takes at most 2.5 ms, and disables
//                                    the tick for at most 8 000 cycles. A received stop frame waits at most 2.5 ms, and
//                                    fewer than 64 bytes arrive meanwhile (receive_buffer.h)
#ifndef BEATRIX_HAL_H
#define BEATRIX_HAL_H

#include <stdint.h>

namespace beatrix {

static const uint8_t NAME_SIZE = 32;

namespace hal {

// Return the number of free bytes in the transmit buffer: at least 128 if it is empty, for a text answer and a reply.
uint16_t transmit_room();
// Queue bytes for transmission; the core has checked transmit_room().
void send(const uint8_t *bytes, uint8_t count);

// Switch the motor drivers on or off. Switching off takes effect before the call returns, and discards pending steps.
void set_drivers(bool on);
// Return the steps of an arm that the last set_drivers(false) discarded, forward minus backward. Call once after each.
int16_t discarded_steps(uint8_t arm);

// Return the number of starts of the board, including this one.
uint32_t boot_number();
// Read and write the robot name in non-volatile memory, padded with zeros. A write may continue in the background.
void load_name(char name[NAME_SIZE]);
void store_name(const char name[NAME_SIZE]);

// Return the number of received bytes lost or discarded since start, at most 255.
uint8_t bytes_lost();

// Restart the watchdog's timeout; called from every poll().
void reset_watchdog();

// Mask and unmask the interrupt of tick(), not those of bytes and steps. A tick that is due meanwhile is delayed. Both
// calls are compiler barriers. Calls cannot be nested.
void disable_tick();
void enable_tick();

}  // namespace hal

class TickDisabled {
 public:
  TickDisabled() { hal::disable_tick(); }
  ~TickDisabled() { hal::enable_tick(); }

 private:
  TickDisabled(const TickDisabled &);
  TickDisabled &operator=(const TickDisabled &);
};

}  // namespace beatrix

#endif
