// The board's behaviour: states, commands, telemetry, heartbeat.
//
// It speaks as it is spoken to: frames to a host whose frames come, and otherwise nothing but the answers to text.
#ifndef BEATRIX_MACHINE_H
#define BEATRIX_MACHINE_H

#include "frame.h"
#include "hal.h"
#include "motion.h"
#include "text.h"

namespace beatrix {

// Types from here on are no requests. They are passed over: a line that echoes must neither be answered nor be taken for
// a host, and the answer to 0x40 would be a TELEMETRY.
static const uint8_t REQUEST_END = FRAME_TELEMETRY & ~REPLY_BIT;
static const uint8_t REPLY_ROOM = uint8_t(HelloReply::SIZE + WIRE_OVERHEAD);

class Machine {
 public:
  // See hal.h for who calls these, and from where.
  void start();
  void receive(uint8_t byte);
  void poll();
  void tick();

  const Motion &motion() const { return motion_; }

  // What the text port sees and does.
  bool enabled() const { return enabled_; }
  bool calibrated() const { return calibrated_; }
  bool emergency() const { return emergency_; }
  uint32_t now() const;  // in ticks
  void read_steps(int32_t steps[ARMS]) const;
  bool arrived() const;      // all steps of the last motion are made, up to its target
  bool text_moving() const;  // in a motion of the text port
  Error enable(uint8_t value);
  Error calibrate();
  // Whoever calls this has checked the move.
  void go(const Move &move, bool straight);
  void stop();
  void say(const char *line, bool last);
  void warn(uint8_t code);

 private:
  void take(Got got);
  void answer();
  bool has_host() const;
  void look_for_silence(uint16_t tick, uint16_t silence);
  bool answers_soon(uint16_t tick) const;
  void report();
  Error obey(uint8_t type, const uint8_t *payload, uint8_t size);
  Error check_move(uint8_t type, const uint8_t *payload) const;
  Error check(const Move &move) const;
  void move(uint8_t type, const uint8_t *payload, uint8_t size);
  bool repeated(uint8_t type, const uint8_t *payload, uint8_t size) const;
  Error set_name(const uint8_t *payload);
  void emergency_stop();
  void switch_off(Outcome why);
  void forget_home();

  void send(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size);
  void send_hello(uint8_t seq);
  uint8_t state() const;
  bool has_news() const;
  Telemetry observe() const;

  Receiver receiver_;
  Motion motion_;
  Plan plan_ = Plan();  // kept: emptying one takes long
  TextPort text_;
  char name_[NAME_SIZE] = {};
  uint8_t last_move_[Move::SIZE] = {};
  uint8_t last_move_type_ = 0;  // of the frame in last_move_; 0: none was made since home is known
  Telemetry reported_ = Telemetry();
  uint32_t tick_ = 0;
  uint16_t motion_number_ = 0;
  uint16_t silence_ = HOST_GONE;  // ms since the last valid frame, as far as it matters
  uint16_t byte_tick_ = 0;        // when poll() last saw that bytes had come
  bool byte_came_ = false;        // since then
  uint8_t telemetry_seq_ = 0;
  uint8_t text_seq_ = 0;
  bool enabled_ = false;
  bool calibrated_ = false;
  bool emergency_ = false;
};

}  // namespace beatrix

#endif
