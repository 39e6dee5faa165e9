// Effect of each request, and its checks.
#include "../speed.h"
#include "machine.h"

#include "name.h"

namespace beatrix {

static_assert(YAW_SUM_MAX / 3 + ARM_TURN <= 0x7FFF, "step counts within the limits fit in 16 bits");

static bool known(uint8_t type) {
  return (type >= FRAME_HELLO && type <= FRAME_TEXT_OPEN) || type == FRAME_MOVE_STRAIGHT || type == FRAME_RESET;
}

static bool fits(uint8_t type, uint8_t size) {
  switch (type) {
    case FRAME_MOVE: return size == Move::SIZE;
    case FRAME_MOVE_STRAIGHT: return size == MoveStraight::SIZE;
    case FRAME_ENABLE: return size == Enable::SIZE;
    case FRAME_SET_NAME: return size == SetName::SIZE;
    default: return size == 0;
  }
}

Error Machine::execute(uint8_t type, const uint8_t *payload, uint8_t size) {
  if (!known(type)) return ERROR_UNKNOWN;
  if (!fits(type, size)) return ERROR_BAD_LENGTH;
  switch (type) {
    case FRAME_MOVE:
    case FRAME_MOVE_STRAIGHT: return check_move(type, payload);
    case FRAME_STOP:
      text_.cancel_motions();
      stop();
      return ERROR_OK;
    case FRAME_EMERGENCY_STOP:
      emergency_stop();
      text_.cancel_motions();
      return ERROR_OK;
    case FRAME_ENABLE:
      if (payload[0] == 0) text_.cancel_motions();
      return enable(payload[0]);
    case FRAME_RESET: return reset();
    case FRAME_CALIBRATE: return calibrate();
    case FRAME_SET_NAME: return set_name(payload);
    case FRAME_TEXT_OPEN: text_.open(*this); return ERROR_OK;
    default: return ERROR_OK;  // PING
  }
}

// Read either frame; the one speed of MOVE_STRAIGHT is used for all arms.
static void read_move(uint8_t type, const uint8_t *payload, Move *move) {
  if (type == FRAME_MOVE) return move->read(payload);
  MoveStraight straight;
  straight.read(payload);
  move->motion = straight.motion;
  for (uint8_t i = 0; i < ARMS; i++) {
    move->target[i] = straight.target[i];
    move->speed[i] = straight.speed;
  }
}

Error Machine::check_move(uint8_t type, const uint8_t *payload) const {
  Move wanted;
  read_move(type, payload, &wanted);
  return check(wanted);
}

// Called after the checks and after the ACK, because planning takes half a millisecond.
void Machine::make_move(uint8_t type, const uint8_t *payload, uint8_t size) {
  if (is_repeated(type, payload, size)) return;
  Move wanted;
  read_move(type, payload, &wanted);
  text_.host_takes_over(*this);
  start_motion(wanted, type == FRAME_MOVE_STRAIGHT);
  for (uint8_t i = 0; i < size; i++) last_move_[i] = payload[i];
  last_move_type_ = type;
}

void Machine::start_motion(const Move &move, bool straight) {
  last_move_type_ = 0;  // the motion may come from the text port; make_move() sets the type after this
  uint32_t distance_to_go[ARMS];
  bool resting;
  {
    TickDisabled disabled;
    motion_.measure(move, distance_to_go, &resting);
  }
  motion_.plan(move, straight, distance_to_go, resting, &plan_);
  TickDisabled disabled;
  motion_.start(plan_);
  if (stop_pending_) motion_.brake(OUTCOME_STOPPED);
  motion_number_ = move.motion;
}

void Machine::stop() {
  TickDisabled disabled;
  motion_.brake(OUTCOME_STOPPED);
}

Error Machine::check(const Move &move) const {
  if (!enabled_) return ERROR_NOT_ENABLED;
  if (!calibrated_) return ERROR_NOT_CALIBRATED;
  for (uint8_t i = 0; i < ARMS; i++) {
    if (move.speed[i] == 0 || move.speed[i] > SPEED_MAX) return ERROR_SPEED;
  }
  int32_t target[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) target[i] = move.target[i];
  switch (check_steps(target)) {
    case OUTCOME_GAP: return ERROR_GAP;
    case OUTCOME_YAW: return ERROR_YAW;
    default: return ERROR_OK;
  }
}

// The host repeats a request whose reply is lost. The same move with the same number runs once, so a repetition
// does not undo a STOP sent between the two.
bool Machine::is_repeated(uint8_t type, const uint8_t *payload, uint8_t size) const {
  if (type != last_move_type_) return false;
  for (uint8_t i = 0; i < size; i++) {
    if (payload[i] != last_move_[i]) return false;
  }
  return true;
}

Error Machine::enable(uint8_t value) {
  if (value > 1) return ERROR_BAD_VALUE;
  if (!value) {
    switch_off(OUTCOME_DISABLED);
  } else if (emergency_) {
    return ERROR_EMERGENCY;
  } else if (!enabled_) {
    clear_calibration();
    hal::set_drivers(true);
    enabled_ = true;
  }
  return ERROR_OK;
}

Error Machine::reset() {
  if (emergency_pending_) return ERROR_EMERGENCY;  // the EMERGENCY_STOP came after this RESET
  emergency_ = false;
  return ERROR_OK;
}

Error Machine::calibrate() {
  if (!enabled_) return ERROR_NOT_ENABLED;
  TickDisabled disabled;
  if (motion_.moving()) return ERROR_NOT_AT_REST;
  int32_t home[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) home[i] = motion_.axis(i).steps();
  text_.home_changed(home);
  motion_.set_home();
  clear_calibration();
  calibrated_ = true;
  reported_ = Telemetry();  // the position changed without a motion: send telemetry at once
  return ERROR_OK;
}

uint32_t Machine::now() const {
  TickDisabled disabled;
  return tick_;
}

void Machine::read_steps(int32_t steps[ARMS]) const {
  TickDisabled disabled;
  for (uint8_t i = 0; i < ARMS; i++) steps[i] = motion_.axis(i).steps();
}

bool Machine::arrived() const {
  TickDisabled disabled;
  if (!motion_.moving()) return motion_.outcome() == OUTCOME_DONE;
  for (uint8_t i = 0; i < ARMS; i++) {
    if (motion_.axis(i).steps() != motion_.axis(i).target()) return false;
  }
  return !motion_.braking();
}

bool Machine::text_moving() const {
  return motion_.moving() && motion_number_ == TEXT_MOTION;
}

Error Machine::set_name(const uint8_t *payload) {
  SetName wanted;
  wanted.read(payload);
  if (!valid_name(wanted.name)) return ERROR_BAD_VALUE;
  for (uint8_t i = 0; i < NAME_SIZE; i++) name_[i] = wanted.name[i];
  hal::store_name(name_);
  return ERROR_OK;
}

void Machine::emergency_stop() {
  switch_off(OUTCOME_EMERGENCY);
  emergency_ = true;
}

void Machine::switch_off(Outcome why) {
  TickDisabled disabled;
  hal::set_drivers(false);
  int16_t discarded_steps[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) discarded_steps[i] = hal::discarded_steps(i);
  motion_.abort(why, discarded_steps);
  if (enabled_) clear_calibration();
  enabled_ = false;
}

void Machine::clear_calibration() {
  calibrated_ = false;
  last_move_type_ = 0;
}

}  // namespace beatrix
