// What each command does, and when it is refused.
#include "machine.h"

#include "name.h"

namespace beatrix {

static_assert(YAW_SUM_MAX / 3 + ARM_TURN <= 0x7FFF, "no arm within the guard is further from their mean than a turn");

static bool known(uint8_t type) {
  return (type >= FRAME_HELLO && type <= FRAME_TEXT_OPEN) || type == FRAME_MOVE_STRAIGHT;
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

Error Machine::obey(uint8_t type, const uint8_t *payload, uint8_t size) {
  if (!known(type)) return ERROR_UNKNOWN;
  if (!fits(type, size)) return ERROR_BAD_LENGTH;
  switch (type) {
    case FRAME_MOVE:
    case FRAME_MOVE_STRAIGHT: return check_move(type, payload);
    case FRAME_STOP:
      text_.call_off();
      stop();
      return ERROR_OK;
    case FRAME_EMERGENCY_STOP:
      emergency_stop();
      text_.call_off();
      return ERROR_OK;
    case FRAME_ENABLE:
      if (payload[0] == 0) text_.call_off();
      return enable(payload[0]);
    case FRAME_CALIBRATE: return calibrate();
    case FRAME_SET_NAME: return set_name(payload);
    case FRAME_TEXT_OPEN: text_.open(*this); return ERROR_OK;
    default: return ERROR_OK;  // PING
  }
}

// A straight motion's one speed stands for those of all arms.
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

// The answer has been sent before: nothing can refuse the move any more, and planning it takes half a millisecond.
void Machine::move(uint8_t type, const uint8_t *payload, uint8_t size) {
  if (repeated(type, payload, size)) return;
  Move wanted;
  read_move(type, payload, &wanted);
  text_.give_way(*this);
  go(wanted, type == FRAME_MOVE_STRAIGHT);
  for (uint8_t i = 0; i < size; i++) last_move_[i] = payload[i];
  last_move_type_ = type;
}

void Machine::go(const Move &move, bool straight) {
  last_move_type_ = 0;  // text may have asked for this one
  uint32_t todo[ARMS];
  bool resting;
  {
    TickHeld held;
    motion_.survey(move, todo, &resting);
  }
  motion_.plan(move, straight, todo, resting, &plan_);
  TickHeld held;
  motion_.start(plan_);
  motion_number_ = move.motion;
}

void Machine::stop() {
  TickHeld held;
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
  switch (guard_steps(target)) {
    case OUTCOME_GAP: return ERROR_GAP;
    case OUTCOME_YAW: return ERROR_YAW;
    default: return ERROR_OK;
  }
}

// The host asks again when an answer is lost: the same move under the same number is made once, and is not begun
// anew after somebody has stopped it.
bool Machine::repeated(uint8_t type, const uint8_t *payload, uint8_t size) const {
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
  } else if (!enabled_) {
    forget_home();
    hal::drivers(true);
    enabled_ = true;
    emergency_ = false;
  }
  return ERROR_OK;
}

Error Machine::calibrate() {
  if (!enabled_) return ERROR_NOT_ENABLED;
  TickHeld held;
  if (motion_.moving()) return ERROR_NOT_AT_REST;
  int32_t home[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) home[i] = motion_.axis(i).steps();
  text_.home_moved(home);
  motion_.zero();
  forget_home();
  calibrated_ = true;
  reported_ = Telemetry();  // the position has changed without a motion: tell at once
  return ERROR_OK;
}

uint32_t Machine::now() const {
  TickHeld held;
  return tick_;
}

void Machine::read_steps(int32_t steps[ARMS]) const {
  TickHeld held;
  for (uint8_t i = 0; i < ARMS; i++) steps[i] = motion_.axis(i).steps();
}

bool Machine::arrived() const {
  TickHeld held;
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
  TickHeld held;
  hal::drivers(false);
  int16_t unmade[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) unmade[i] = hal::unmade(i);
  motion_.abort(why, unmade);
  if (enabled_) forget_home();
  enabled_ = false;
}

void Machine::forget_home() {
  calibrated_ = false;
  last_move_type_ = 0;
}

}  // namespace beatrix
