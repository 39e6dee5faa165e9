// The old text protocol of 2023, as programs of that time see it: two lines for every command, one command at a time.
//
// Its positions count from a zero of its own: a program's @CALNOW does not move the limits, which belong to home.
#ifndef BEATRIX_TEXT_H
#define BEATRIX_TEXT_H

#include "reach.h"
#include "text_queue.h"

namespace beatrix {

class Machine;

class TextPort {
 public:
  // As after a reset: nothing waits, not calibrated, the present position is 0.
  void open(Machine &machine);
  // A line of text has come: it is answered when those before it are. STOP acts here.
  void take(Machine &machine, const uint8_t *line, uint8_t size);
  // Answers what can be answered now; to be called at least every millisecond.
  void poll(Machine &machine);

  // Somebody has stopped the arms: no move that waits is made.
  void call_off();
  // A motion of the host takes the place of ours.
  void give_way(const Machine &machine);
  // The machine counts from another home, which was at `steps`.
  void home_moved(const int32_t steps[ARMS]);

 private:
  // What the command whose turn it is waits for before its second reply.
  enum Phase : uint8_t {
    IDLE,        // there is none
    SETTLING,    // the last steps of the move before, to begin its own
    MOVING,      // its last step
    PRETENDING,  // as long as the arms would have needed
    STOPPING,    // arms at rest
    ARRIVED,     // the motors, which follow the tick
    LOST,        // nothing any more: somebody else has ended it
  };

  bool proceed(Machine &machine);
  void begin(Machine &machine, const Order &order);
  void answer(Machine &machine, Verb verb);
  void begin_move(Machine &machine);
  void pretend(Machine &machine, const int32_t from[ARMS], const int32_t target[ARMS]);
  void end(Machine &machine, bool done);
  void tell_position(Machine &machine, uint8_t arm) const;
  void tell_positions(Machine &machine) const;
  void warn(Warning warning) { warnings_ = uint8_t(warnings_ | 1 << warning); }
  void send_warnings(Machine &machine);

  TextQueue queue_;
  Order order_ = plain_order(VERB_UNKNOWN);  // whose turn it is, unless idle
  Phase phase_ = IDLE;
  bool calibrated_ = false;
  int32_t zero_[ARMS] = {0, 0, 0};    // where the port's zero is, in steps from home
  int32_t counted_[ARMS] = {0, 0, 0}; // pretending: what the move adds to the port's position
  uint32_t begun_ = 0;                // pretending, arrived: since this tick
  uint32_t duration_ = 0;             // pretending: in ticks
  uint8_t warnings_ = 0;              // to be sent, a bit for each code
};

}  // namespace beatrix

#endif
