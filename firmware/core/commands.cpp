// What each command does, and when it is refused.
#include "machine.h"

#include "name.h"

namespace beatrix {

static_assert(YAW_SUM_MAX / 3 + ARM_TURN <= 0x7FFF, "no arm within the guard is further from their mean than a turn");

static bool fits(uint8_t type, uint8_t size) {
  switch (type) {
    case FRAME_MOVE: return size == Move::SIZE;
    case FRAME_ENABLE: return size == Enable::SIZE;
    case FRAME_SET_NAME: return size == SetName::SIZE;
    default: return size == 0;
  }
}

Error Machine::obey(uint8_t type, const uint8_t *payload, uint8_t size) {
  if (type < FRAME_HELLO || type > FRAME_TEXT_OPEN) return ERROR_UNKNOWN;
  if (!fits(type, size)) return ERROR_BAD_LENGTH;
  switch (type) {
    case FRAME_MOVE: return check_move(payload);
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

Error Machine::check_move(const uint8_t *payload) const {
  Move wanted;
  wanted.read(payload);
  return check(wanted);
}

// The answer has been sent before: nothing can refuse the move any more, and planning it takes half a millisecond.
void Machine::move(const uint8_t *payload) {
  if (repeated(payload)) return;
  Move wanted;
  wanted.read(payload);
  text_.give_way(*this);
  go(wanted);
  for (uint8_t i = 0; i < Move::SIZE; i++) last_move_[i] = payload[i];
  has_moved_ = true;
}

void Machine::go(const Move &move) {
  uint32_t todo[ARMS];
  bool resting;
  {
    TickHeld held;
    motion_.survey(move, todo, &resting);
  }
  motion_.plan(move, todo, resting, &plan_);
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
  if (move.flags & ~MOVE_STRAIGHT) return ERROR_BAD_VALUE;
  uint8_t speeds = move.flags & MOVE_STRAIGHT ? 1 : ARMS;
  for (uint8_t i = 0; i < speeds; i++) {
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
bool Machine::repeated(const uint8_t *payload) const {
  if (!has_moved_) return false;
  for (uint8_t i = 0; i < Move::SIZE; i++) {
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
  has_moved_ = false;
}

}  // namespace beatrix
