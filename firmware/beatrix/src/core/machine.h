// State machine of the board: states, requests, telemetry, heartbeat.
//
// Until two seconds after a valid frame, the board sends frames. Otherwise it sends only plain replies to text.
#ifndef BEATRIX_MACHINE_H
#define BEATRIX_MACHINE_H

#include "frame.h"
#include "hal.h"
#include "receive_buffer.h"
#include "motion.h"
#include "text_port.h"

namespace beatrix {

// Types from here on are ignored: an echo of our own frames must neither get a reply nor count as a host, and the reply
// to 0x40 would have the type of TELEMETRY.
static const uint8_t REQUEST_END = FRAME_TELEMETRY & ~REPLY_BIT;
static const uint8_t REPLY_ROOM = uint8_t(HelloReply::SIZE + WIRE_OVERHEAD);

class Machine {
 public:
  // Called by the target, see hal.h.
  void start();
  void process(ReceiveBuffer &buffer, uint8_t most);
  void poll();
  void tick();

  const Motion &motion() const { return motion_; }

  // Interface for the text port.
  bool enabled() const { return enabled_; }
  bool calibrated() const { return calibrated_; }
  bool emergency() const { return emergency_; }
  uint32_t now() const;  // in ticks
  void read_steps(int32_t steps[ARMS]) const;
  bool arrived() const;      // the steps of the last motion have reached its target
  bool text_moving() const;  // a motion of the text port is running
  Error enable(uint8_t value);
  Error calibrate();
  // Start a motion; the caller has checked the move.
  void start_motion(const Move &move, bool straight);
  void stop();
  void send_text(const char *line, bool last);
  void send_text_warning(uint8_t code);

 private:
  void scan(ReceiveBuffer &buffer);
  void act_on_stops(ReceiveBuffer &buffer);
  void finish_stop(ReceiveBuffer &buffer);
  bool receive(uint8_t byte);
  void handle(Received received);
  void restart_host_timeout();
  void handle_frame();
  bool has_host() const;
  void check_timeouts(uint16_t tick, uint16_t silence);
  bool reply_expected(uint16_t tick) const;
  void send_telemetry();
  Error execute(uint8_t type, const uint8_t *payload, uint8_t size);
  Error check_move(uint8_t type, const uint8_t *payload) const;
  Error check(const Move &move) const;
  void make_move(uint8_t type, const uint8_t *payload, uint8_t size);
  bool is_repeated(uint8_t type, const uint8_t *payload, uint8_t size) const;
  Error reset();
  Error set_name(const uint8_t *payload);
  void emergency_stop();
  void switch_off(Outcome why);
  void clear_calibration();

  void send_ack(uint8_t type, uint8_t seq, Error error);
  void send(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size);
  void send_hello(uint8_t seq);
  uint8_t state() const;
  bool telemetry_due() const;
  Telemetry current_telemetry() const;

  Receiver receiver_;
  Motion motion_;
  Plan plan_ = Plan();  // a member, because clearing a local one takes long
  TextPort text_;
  char name_[NAME_SIZE] = {};
  uint8_t last_move_[Move::SIZE] = {};
  uint8_t last_move_type_ = 0;  // of the frame in last_move_; 0: none since calibration or a text motion
  Telemetry reported_ = Telemetry();
  uint32_t tick_ = 0;
  uint16_t motion_number_ = 0;
  uint16_t host_silence_ = HOST_GONE;  // ms since the last valid frame, at most HOST_GONE
  uint16_t byte_tick_ = 0;        // tick of the last poll() that found new bytes
  bool byte_received_ = false;        // since the last poll()
  bool stop_pending_ = false;        // stop frames were carried out before the bytes ahead of them
  bool emergency_pending_ = false;  // one of them is an EMERGENCY_STOP: a RESET ahead of it is refused
  uint8_t telemetry_seq_ = 0;
  uint8_t text_seq_ = 0;
  bool enabled_ = false;
  bool calibrated_ = false;
  bool emergency_ = false;
};

}  // namespace beatrix

#endif
