// The board's behaviour: states, commands, telemetry, heartbeat.
#ifndef BEATRIX_MACHINE_H
#define BEATRIX_MACHINE_H

#include "frame.h"
#include "hal.h"
#include "motion.h"

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
  Limits &limits() { return motion_.limits; }

 private:
  void answer();
  Error obey(uint8_t type, const uint8_t *payload, uint8_t size);
  Error check_move(const uint8_t *payload) const;
  Error check(const Move &move) const;
  void move(const uint8_t *payload);
  bool repeated(const uint8_t *payload) const;
  Error enable(uint8_t value);
  Error calibrate();
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
  char name_[NAME_SIZE] = {};
  uint8_t last_move_[Move::SIZE] = {};
  Telemetry reported_ = Telemetry();
  uint32_t tick_ = 0;
  uint16_t motion_number_ = 0;
  uint16_t silence_ = 0;  // ms since the last valid frame
  uint8_t telemetry_seq_ = 0;
  bool has_moved_ = false;  // last_move_ holds a move made since home is known
  bool enabled_ = false;
  bool calibrated_ = false;
  bool emergency_ = false;
};

}  // namespace beatrix

#endif
