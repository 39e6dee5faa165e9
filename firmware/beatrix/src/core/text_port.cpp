// Text protocol of 2023: effect and replies of each command.
#include "../speed.h"
#include "text_port.h"

#include "machine.h"
#include "text_number.h"

namespace beatrix {

// Bytes of the longest immediate answer in frames, that of @GETALLPOS: a line of three numbers and three short lines.
static const uint8_t ANSWER_ROOM = uint8_t(3 * NUMBER_SIZE + 3 + 4 + 1 + 4 + 4 * (1 + WIRE_OVERHEAD));
// Ticks until the steps of a tick are made: the target makes them in the following millisecond.
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
  TextCommand command = parse_command(line, size);
  if (command.kind == COMMAND_STOP) {
    machine.stop();
    cancel_motions();
  }
  if (!queue_.put(command)) queue_warning(WARNING_BUSY);
  poll(machine);
}

void TextPort::cancel_motions() {
  queue_.cancel_motions();
  if (phase_ == WAITING_FOR_REST || phase_ == COUNTING_ONLY) phase_ = CANCELLED;
}

void TextPort::host_takes_over(const Machine &machine) {
  cancel_motions();
  if (phase_ != MOVING) return;
  phase_ = machine.arrived() ? ARRIVED : CANCELLED;
  since_tick_ = machine.now();
}

void TextPort::home_changed(const int32_t steps[ARMS]) {
  for (uint8_t i = 0; i < ARMS; i++) zero_[i] -= steps[i];
}

static_assert(ANSWER_ROOM + REPLY_ROOM <= 128, "hal.h guarantees no more room");

// Replies to frames have priority: room for one is always left.
void TextPort::poll(Machine &machine) {
  if (warnings_) send_warnings(machine);
  while (hal::transmit_room() >= ANSWER_ROOM + REPLY_ROOM) {
    if (phase_ != IDLE) {
      if (!advance(machine)) return;
    } else if (queue_.empty()) {
      return;
    } else {
      begin(machine, queue_.take());
    }
  }
}

void TextPort::begin(Machine &machine, const TextCommand &command) {
  if (command.kind == COMMAND_UNKNOWN) {
    machine.send_text("NACK\n", true);
    return;
  }
  machine.send_text("ACK\n", false);
  command_ = command;
  if (command.kind == COMMAND_STOP) {
    phase_ = STOPPING;
  } else if (command.is_motion() && calibrated_) {
    phase_ = WAITING_FOR_REST;
  } else {
    execute(machine, command.kind);
  }
}

// Advance the current command by a phase; return false while it has to wait.
bool TextPort::advance(Machine &machine) {
  const Motion &motion = machine.motion();
  switch (phase_) {
    case IDLE: break;
    case WAITING_FOR_REST:
      if (machine.text_moving()) return false;
      start_move(machine);
      break;
    case MOVING:
      // Here a motion ends with its last step, although the set point is still less than a step from its target.
      if (machine.arrived()) {
        phase_ = ARRIVED;
        since_tick_ = machine.now();
      } else if (motion.moving()) {
        return false;
      } else {
        phase_ = CANCELLED;
      }
      break;
    case COUNTING_ONLY:
      if (machine.now() - since_tick_ < duration_) return false;
      for (uint8_t i = 0; i < ARMS; i++) zero_[i] -= counted_steps_[i];
      end(machine, true);
      break;
    case STOPPING:
      if (motion.braking()) return false;
      end(machine, true);
      break;
    case ARRIVED:
      if (machine.now() - since_tick_ < STEPS_BEHIND) return false;
      end(machine, true);
      break;
    case CANCELLED: end(machine, false); break;
  }
  return true;
}

void TextPort::end(Machine &machine, bool done) {
  phase_ = IDLE;
  machine.send_text(done ? "ACK\n" : "NACK\n", true);
}

void TextPort::execute(Machine &machine, CommandKind kind) {
  bool done = true;
  switch (kind) {
    case COMMAND_MOTORS_ON:
      calibrated_ = false;
      // Only RESET clears an emergency, because programs send @ENMOTORS ON whenever they start.
      done = machine.enable(1) == ERROR_OK;
      if (!done) queue_warning(WARNING_EMERGENCY);
      break;
    case COMMAND_MOTORS_OFF:
      calibrated_ = false;
      machine.enable(0);
      break;
    case COMMAND_CALIBRATE:
      if (machine.enabled() && !machine.calibrated()) machine.calibrate();
      machine.read_steps(zero_);
      calibrated_ = true;
      break;
    case COMMAND_GET_CALIBRATED: done = calibrated_; break;
    case COMMAND_GET_CONNECTED: break;
    case COMMAND_GET_X:
    case COMMAND_GET_Y:
    case COMMAND_GET_Z: send_position(machine, uint8_t(kind - COMMAND_GET_X)); break;
    case COMMAND_GET_ALL: send_positions(machine); break;
    default: done = false; break;  // a rejected command, or a motion before @CALNOW
  }
  end(machine, done);
}

// Called only while the port is calibrated. With motors off, the motion is only counted, as in 2023. After an
// emergency, or if the motors are on and home is unknown, it is refused, because the port's zero may be wrong.
void TextPort::start_move(Machine &machine) {
  if (machine.emergency() || (machine.enabled() && !machine.calibrated())) {
    queue_warning(machine.emergency() ? WARNING_EMERGENCY : WARNING_HOME_UNKNOWN);
    return end(machine, false);
  }
  int32_t from[ARMS];
  machine.read_steps(from);
  int32_t target[ARMS];
  for (uint8_t i = 0; i < ARMS; i++) {
    bool stays = command_.kind >= COMMAND_MOVE_X_TO && command_.kind != COMMAND_MOVE_X_TO + i;
    int32_t base = stays || command_.kind == COMMAND_MOVE_BY ? from[i] : zero_[i];
    target[i] = base + command_.steps[i];
  }
  if (!machine.enabled()) return count_only(machine, from, target);
  Warning limit = shorten_to_limits(from, target);
  if (limit != NOT_SHORTENED) queue_warning(limit);
  Move move = Move();
  for (uint8_t i = 0; i < ARMS; i++) move.target[i] = int16_t(target[i]);
  move.motion = TEXT_MOTION;
  move.speed[0] = uint16_t(TEXT_SPEED);
  machine.start_motion(move, true);
  phase_ = MOVING;
}

// Return the ticks of a straight motion from rest. Its second half mirrors the first.
static uint32_t motion_ticks(uint32_t steps, const Fixed &top, const Fixed &acceleration) {
  Fixed halfway = half(to_fixed(int32_t(steps))), distance, speed;
  uint32_t ticks = 0;
  while (distance < halfway && speed < top) {
    speed = speed + acceleration;
    distance = distance + speed;
    ticks++;
  }
  if (distance < halfway) ticks += uint32_t((halfway - distance).value() / top.value());
  return 2 * ticks;
}

void TextPort::count_only(Machine &machine, const int32_t from[ARMS], const int32_t target[ARMS]) {
  queue_warning(WARNING_MOTORS_OFF);
  uint32_t longest = 0;
  for (uint8_t i = 0; i < ARMS; i++) {
    counted_steps_[i] = target[i] - from[i];
    uint32_t distance = uint32_t(counted_steps_[i] < 0 ? -counted_steps_[i] : counted_steps_[i]);
    if (distance > longest) longest = distance;
  }
  duration_ = motion_ticks(longest, from_quarters(uint16_t(TEXT_SPEED)), from_q26(ACCELERATION));
  since_tick_ = machine.now();
  phase_ = COUNTING_ONLY;
}

void TextPort::send_position(Machine &machine, uint8_t arm) const {
  int32_t steps[ARMS];
  machine.read_steps(steps);
  char line[NUMBER_SIZE + 3];
  char *at = write_number(steps[arm] - zero_[arm], line);
  *at++ = '\r';
  *at++ = '\n';
  *at = 0;
  machine.send_text(line, false);
}

void TextPort::send_positions(Machine &machine) const {
  int32_t steps[ARMS];
  machine.read_steps(steps);
  char line[ARMS * (NUMBER_SIZE + 1) + 1];
  char *at = line;
  for (uint8_t i = 0; i < ARMS; i++) {
    at = write_number(steps[i] - zero_[i], at);
    *at++ = i < ARMS - 1 ? ' ' : '\n';
  }
  *at = 0;
  machine.send_text("\n", false);
  machine.send_text(line, false);
}

void TextPort::send_warnings(Machine &machine) {
  for (uint8_t code = 0; code < 8; code++) {
    if (!(warnings_ & 1 << code)) continue;
    if (hal::transmit_room() < WARNING_ROOM + REPLY_ROOM) return;
    machine.send_text_warning(code);
    warnings_ = uint8_t(warnings_ & ~(1 << code));
  }
}

}  // namespace beatrix
