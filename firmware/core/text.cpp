// The old text protocol: what each command does, and its answers.
#include "text.h"

#include "machine.h"
#include "text_number.h"

namespace beatrix {

// What the longest answer without waiting takes in frames: that of @GETALLPOS, a line of three numbers between three
// short ones.
static const uint8_t ANSWER_ROOM = uint8_t(3 * NUMBER_SIZE + 3 + 4 + 1 + 4 + 4 * (1 + WIRE_OVERHEAD));
// Ticks after which the steps of a tick are made surely: the body makes them in the millisecond that follows.
static const uint8_t STEPS_BEHIND = 2;
static const uint8_t WARNING_ROOM = uint8_t(TextWarning::SIZE + WIRE_OVERHEAD);

void TextPort::open(Machine &machine) {
  if (phase_ == MOVING) machine.stop();
  queue_.clear();
  phase_ = IDLE;
  calibrated_ = false;
  warnings_ = 0;
  machine.read_steps(zero_);
}

void TextPort::take(Machine &machine, const uint8_t *line, uint8_t size) {
  Order order = read_order(line, size);
  if (order.verb == VERB_STOP) {
    machine.stop();
    call_off();
  }
  if (!queue_.put(order)) warn(WARNING_BUSY);
  poll(machine);
}

void TextPort::call_off() {
  queue_.call_off();
  if (phase_ == SETTLING || phase_ == PRETENDING) phase_ = LOST;
}

void TextPort::give_way(const Machine &machine) {
  call_off();
  if (phase_ != MOVING) return;
  phase_ = machine.arrived() ? ARRIVED : LOST;
  begun_ = machine.now();
}

void TextPort::home_moved(const int32_t steps[ARMS]) {
  for (uint8_t i = 0; i < ARMS; i++) zero_[i] -= steps[i];
}

static_assert(ANSWER_ROOM + REPLY_ROOM <= 128, "hal.h promises no more room");

// Replies to frames go first: room for one is always left.
void TextPort::poll(Machine &machine) {
  if (warnings_) send_warnings(machine);
  while (hal::room() >= ANSWER_ROOM + REPLY_ROOM) {
    if (phase_ != IDLE) {
      if (!proceed(machine)) return;
    } else if (queue_.empty()) {
      return;
    } else {
      begin(machine, queue_.take());
    }
  }
}

void TextPort::begin(Machine &machine, const Order &order) {
  if (order.verb == VERB_UNKNOWN) {
    machine.say("NACK\n", true);
    return;
  }
  machine.say("ACK\n", false);
  order_ = order;
  if (order.verb == VERB_STOP) {
    phase_ = STOPPING;
  } else if (order.moves() && calibrated_) {
    phase_ = SETTLING;
  } else {
    answer(machine, order.verb);
  }
}

// False: the time for the second reply has not come.
bool TextPort::proceed(Machine &machine) {
  const Motion &motion = machine.motion();
  switch (phase_) {
    case IDLE: break;
    case SETTLING:
      if (machine.text_moving()) return false;
      begin_move(machine);
      break;
    case MOVING:
      // At rest is who has made the last step: what is left of the motion is less than a step.
      if (machine.arrived()) {
        phase_ = ARRIVED;
        begun_ = machine.now();
      } else if (motion.moving()) {
        return false;
      } else {
        phase_ = LOST;
      }
      break;
    case PRETENDING:
      if (machine.now() - begun_ < duration_) return false;
      for (uint8_t i = 0; i < ARMS; i++) zero_[i] -= counted_[i];
      end(machine, true);
      break;
    case STOPPING:
      if (motion.braking()) return false;
      end(machine, true);
      break;
    case ARRIVED:
      if (machine.now() - begun_ < STEPS_BEHIND) return false;
      end(machine, true);
      break;
    case LOST: end(machine, false); break;
  }
  return true;
}

void TextPort::end(Machine &machine, bool done) {
  phase_ = IDLE;
  machine.say(done ? "ACK\n" : "NACK\n", true);
}

void TextPort::answer(Machine &machine, Verb verb) {
  bool done = true;
  switch (verb) {
    case VERB_MOTORS_ON:
      calibrated_ = false;
      // An emergency is ended by those who see the robot, not by a program that begins.
      done = !machine.emergency();
      if (done) {
        machine.enable(1);
      } else {
        warn(WARNING_EMERGENCY);
      }
      break;
    case VERB_MOTORS_OFF:
      calibrated_ = false;
      machine.enable(0);
      break;
    case VERB_CALIBRATE:
      if (machine.enabled() && !machine.calibrated()) machine.calibrate();
      machine.read_steps(zero_);
      calibrated_ = true;
      break;
    case VERB_ASK_CALIBRATED: done = calibrated_; break;
    case VERB_ASK_ALIVE: break;
    case VERB_ASK_X:
    case VERB_ASK_Y:
    case VERB_ASK_Z: tell_position(machine, uint8_t(verb - VERB_ASK_X)); break;
    case VERB_ASK_ALL: tell_positions(machine); break;
    default: done = false; break;  // a refusal, or a move before @CALNOW
  }
  end(machine, done);
}

// The port's calibration has allowed the move, as in 2023. What comes of it is the machine's matter: with motors off
// it is counted only, as then. Not so after an emergency, or if home was lost without the program's doing: then steps
// would be reported, or made, that nobody can answer for.
void TextPort::begin_move(Machine &machine) {
  if (machine.emergency() || (machine.enabled() && !machine.calibrated())) {
    warn(machine.emergency() ? WARNING_EMERGENCY : WARNING_HOME_UNKNOWN);
    return end(machine, false);
  }
  int32_t from[ARMS];
  machine.read_steps(from);
  int32_t target[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    bool stays = order_.verb >= VERB_MOVE_X_TO && order_.verb != VERB_MOVE_X_TO + i;
    int32_t base = stays || order_.verb == VERB_MOVE_BY ? from[i] : zero_[i];
    target[i] = base + order_.steps[i];
  }
  if (!machine.enabled()) return pretend(machine, from, target);
  Warning limit = shorten(from, target);
  if (limit != WITHIN_REACH) warn(limit);
  Move move = Move();
  for (uint8_t i = 0; i < ARMS; i++) move.target[i] = int16_t(target[i]);
  move.motion = TEXT_MOTION;
  move.speed[0] = uint16_t(TEXT_SPEED);
  machine.go(move, true);
  phase_ = MOVING;
}

// How long a straight motion from rest takes: half of it up the ramp and along, the other half the same backwards.
static uint32_t ticks_for(uint32_t steps, const Fine &top, const Fine &acceleration) {
  Fine there = half(to_fine(int32_t(steps))), way, speed;
  uint32_t ticks = 0;
  while (way < there && speed < top) {
    speed = speed + acceleration;
    way = way + speed;
    ticks++;
  }
  if (way < there) ticks += uint32_t((there - way).whole() / top.whole());
  return 2 * ticks;
}

void TextPort::pretend(Machine &machine, const int32_t from[ARMS], const int32_t target[ARMS]) {
  warn(WARNING_MOTORS_OFF);
  uint32_t most = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    counted_[i] = target[i] - from[i];
    uint32_t way = uint32_t(counted_[i] < 0 ? -counted_[i] : counted_[i]);
    if (way > most) most = way;
  }
  duration_ = ticks_for(most, from_quarters(uint16_t(TEXT_SPEED)), from_q26(ACCELERATION));
  begun_ = machine.now();
  phase_ = PRETENDING;
}

void TextPort::tell_position(Machine &machine, uint8_t arm) const {
  int32_t steps[ARMS];
  machine.read_steps(steps);
  char line[NUMBER_SIZE + 3];
  char *at = write_number(steps[arm] - zero_[arm], line);
  *at++ = '\r';
  *at++ = '\n';
  *at = 0;
  machine.say(line, false);
}

void TextPort::tell_positions(Machine &machine) const {
  int32_t steps[ARMS];
  machine.read_steps(steps);
  char line[ARMS * (NUMBER_SIZE + 1) + 1];
  char *at = line;
  for (uint8_t i = 0; i < ARMS; i++) {
    at = write_number(steps[i] - zero_[i], at);
    *at++ = i < ARMS - 1 ? ' ' : '\n';
  }
  *at = 0;
  machine.say("\n", false);
  machine.say(line, false);
}

void TextPort::send_warnings(Machine &machine) {
  for (uint8_t code = 0; code < 8; code++) {
    if (!(warnings_ & 1 << code)) continue;
    if (hal::room() < WARNING_ROOM + REPLY_ROOM) return;
    machine.warn(code);
    warnings_ = uint8_t(warnings_ & ~(1 << code));
  }
}

}  // namespace beatrix
