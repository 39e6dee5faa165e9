// Text protocol of 2023: two replies to every known command, one command at a time.
//
// Its positions count from its own zero, so that @CALNOW need not move a known home, from which the limits count.
#ifndef BEATRIX_TEXT_PORT_H
#define BEATRIX_TEXT_PORT_H

#include "text_limits.h"
#include "text_queue.h"

namespace beatrix {

class Machine;

class TextPort {
 public:
  // Stop a text motion and reset the port: empty queue, not calibrated, zero at the present position. Home is kept.
  void open(Machine &machine);
  // Queue a line of text; its replies follow those of earlier lines. @STOPALL is carried out here.
  void take(Machine &machine, const uint8_t *line, uint8_t size);
  // Execute queued commands and send the replies that are due; called at least every millisecond.
  void poll(Machine &machine);

  // Cancel the queued motions, after a stop.
  void cancel_motions();
  // Cancel the queued motions and end the running one, because a motion of the host replaces them.
  void host_takes_over(const Machine &machine);
  // Keep the port's zero in place after home has moved to the position that was `steps`.
  void home_changed(const int32_t steps[ARMS]);

 private:
  // Phase of the current command: the event or time for which its second reply waits.
  enum Phase : uint8_t {
    IDLE,        // no current command
    WAITING_FOR_REST,    // the end of the previous text motion; then that of this command starts
    MOVING,      // the last step of the motion of this command
    COUNTING_ONLY,  // motors are off: the time that the motion would take
    STOPPING,    // the end of braking
    ARRIVED,     // the last step of the motors, which follow the tick
    CANCELLED,        // nothing: a stop or another motion has ended the motion
  };

  bool advance(Machine &machine);
  void begin(Machine &machine, const TextCommand &command);
  void execute(Machine &machine, CommandKind kind);
  void start_move(Machine &machine);
  void count_only(Machine &machine, const int32_t from[ARMS], const int32_t target[ARMS]);
  void end(Machine &machine, bool done);
  void send_position(Machine &machine, uint8_t arm) const;
  void send_positions(Machine &machine) const;
  void queue_warning(Warning warning) { warnings_ = uint8_t(warnings_ | 1 << warning); }
  void send_warnings(Machine &machine);

  TextQueue queue_;
  TextCommand command_ = command_of_kind(COMMAND_UNKNOWN);  // the current one, unless IDLE
  Phase phase_ = IDLE;
  bool calibrated_ = false;
  int32_t zero_[ARMS] = {0, 0, 0};    // the port's zero, in steps from home
  int32_t counted_steps_[ARMS] = {0, 0, 0}; // COUNTING_ONLY: steps that the motion adds to the port's position
  uint32_t since_tick_ = 0;                // COUNTING_ONLY, ARRIVED: tick at which the phase began
  uint32_t duration_ = 0;             // COUNTING_ONLY: in ticks
  uint8_t warnings_ = 0;              // to send, one bit for each code
};

}  // namespace beatrix

#endif
