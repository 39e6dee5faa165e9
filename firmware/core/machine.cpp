// The board's behaviour: state, heartbeat, telemetry. Commands are in commands.cpp.
#include "machine.h"

#include "name.h"

namespace beatrix {

void Machine::start() {
  hal::drivers(false);
  hal::load_name(name_);
  if (!valid_name(name_)) name_[0] = 0;
}

void Machine::receive(uint8_t byte) {
  byte_came_ = true;
  Got got = receiver_.take(byte);
  if (got != GOT_NOTHING) take(got);
}

// Not part of receive(): every byte would have to make room for a frame on the stack.
__attribute__((noinline)) void Machine::take(Got got) {
  if (got == GOT_LINE) text_.take(*this, receiver_.line(), receiver_.line_size());
  if (got != GOT_FRAME || receiver_.type() >= REQUEST_END) return;
  {
    TickHeld held;
    silence_ = 0;
  }
  answer();
}

void Machine::answer() {
  if (receiver_.type() == FRAME_HELLO && receiver_.size() == 0) {
    send_hello(receiver_.seq());
    return;
  }
  Ack ack;
  ack.error = obey(receiver_.type(), receiver_.payload(), receiver_.size());
  uint8_t payload[Ack::SIZE];
  ack.write(payload);
  send(uint8_t(receiver_.type() | REPLY_BIT), receiver_.seq(), payload, Ack::SIZE);
  if (ack.error == ERROR_OK && (receiver_.type() == FRAME_MOVE || receiver_.type() == FRAME_MOVE_STRAIGHT)) {
    move(receiver_.type(), receiver_.payload(), receiver_.size());
  }
}

// Without a host there is no heartbeat: a program that opens the board itself only speaks when it wants something.
void Machine::tick() {
  tick_++;
  if (silence_ < HOST_GONE) silence_++;
  if (silence_ >= HEARTBEAT_TIMEOUT && (silence_ < HOST_GONE || motion_number_ != TEXT_MOTION)) {
    motion_.brake(OUTCOME_HOST_LOST);
  }
  motion_.tick();
}

void Machine::poll() {
  hal::kick_watchdog();
  uint16_t tick, silence;
  {
    TickHeld held;
    tick = uint16_t(tick_);
    silence = silence_;
  }
  look_for_silence(tick, silence);
  text_.poll(*this);
  if (silence < HOST_GONE && !answers_soon(tick)) report();
}

// Behind a TELEMETRY that has just begun an answer would have to wait for longer than its question takes.
bool Machine::answers_soon(uint16_t tick) const {
  return receiver_.in_frame() && uint16_t(tick - byte_tick_) <= 1 &&
         uint16_t(tick - reported_.tick) < TELEMETRY_PERIOD + TELEMETRY_PATIENCE;
}

void Machine::look_for_silence(uint16_t tick, uint16_t silence) {
  if (byte_came_) {
    byte_came_ = false;
    byte_tick_ = tick;
  } else if (uint16_t(tick - byte_tick_) >= TEXT_LINE_TIMEOUT) {
    byte_tick_ = tick;
    receiver_.give_up();
  }
  // The host that passed lines on is gone, and with it whoever could have stopped what they ask for.
  if (silence >= HEARTBEAT_TIMEOUT && silence < HOST_GONE) text_.call_off();
}

bool Machine::has_host() const {
  TickHeld held;
  return silence_ < HOST_GONE;
}

// Telemetry falls behind replies: it is only sent while a reply would still fit, and again later if it was not.
void Machine::report() {
  if (!has_news() || hal::room() < Telemetry::SIZE + WIRE_OVERHEAD + REPLY_ROOM) return;
  reported_ = observe();
  uint8_t payload[Telemetry::SIZE];
  reported_.write(payload);
  send(FRAME_TELEMETRY, telemetry_seq_++, payload, Telemetry::SIZE);
}

bool Machine::has_news() const {
  TickHeld held;
  return state() != reported_.state || motion_.outcome() != reported_.outcome || motion_number_ != reported_.motion ||
         uint16_t(uint16_t(tick_) - reported_.tick) >= TELEMETRY_PERIOD;
}

Telemetry Machine::observe() const {
  TickHeld held;
  Telemetry now;
  now.tick = uint16_t(tick_);
  now.boot = uint16_t(hal::boot_number());
  now.state = state();
  now.outcome = motion_.outcome();
  now.motion = motion_number_;
  for (uint8_t i = 0; i < ARMS; i++) {
    now.position[i] = int16_t(motion_.axis(i).steps());
    now.velocity[i] = to_rate(motion_.axis(i).velocity());
  }
  now.rejected = receiver_.rejected();
  return now;
}

uint8_t Machine::state() const {
  return uint8_t((enabled_ ? STATE_ENABLED : 0) | (calibrated_ ? STATE_CALIBRATED : 0) |
                 (motion_.moving() ? STATE_MOVING : 0) | (motion_.braking() ? STATE_STOPPING : 0) |
                 (emergency_ ? STATE_EMERGENCY : 0));
}

void Machine::send(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size) {
  uint8_t wire[MAX_WIRE];
  hal::send(wire, encode(type, seq, payload, size, wire));
}

void Machine::say(const char *line, bool last) {
  uint8_t payload[MAX_PAYLOAD];
  uint8_t size = Text::SIZE;
  payload[0] = last ? TEXT_LAST : 0;
  while (*line) payload[size++] = uint8_t(*line++);
  if (has_host()) {
    send(FRAME_TEXT, text_seq_++, payload, size);
  } else {
    hal::send(payload + Text::SIZE, uint8_t(size - Text::SIZE));
  }
}

// Who opens the board directly knows no warnings.
void Machine::warn(uint8_t code) {
  TextWarning warning;
  warning.code = code;
  uint8_t payload[TextWarning::SIZE];
  warning.write(payload);
  if (has_host()) send(FRAME_TEXT_WARNING, text_seq_++, payload, TextWarning::SIZE);
}

void Machine::send_hello(uint8_t seq) {
  HelloReply hello;
  hello.contract = CONTRACT;
  hello.version[0] = VERSION_MAJOR;
  hello.version[1] = VERSION_MINOR;
  hello.version[2] = VERSION_PATCH;
  hello.boot = hal::boot_number();
  for (uint8_t i = 0; i < NAME_SIZE; i++) hello.name[i] = name_[i];
  uint8_t payload[HelloReply::SIZE];
  hello.write(payload);
  send(FRAME_HELLO_REPLY, seq, payload, HelloReply::SIZE);
}

}  // namespace beatrix
