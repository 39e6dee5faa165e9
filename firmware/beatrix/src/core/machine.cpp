// State machine of the board: heartbeat, telemetry, replies. Requests are in commands.cpp.
#include "../speed.h"
#include "machine.h"

#include "name.h"

namespace beatrix {

void Machine::start() {
  hal::set_drivers(false);
  hal::load_name(name_);
  if (!valid_name(name_)) name_[0] = 0;
}

// A stop frame is carried out twice: when it is found, and in its turn, when it is also acknowledged. In between,
// requests that arrived before it can neither start a motion (start_motion) nor clear the latch (reset).
void Machine::process(ReceiveBuffer &buffer, uint8_t most) {
  scan(buffer);
  bool room = hal::transmit_room() >= REPLY_ROOM;
  for (; most && room; most--) {
    if (stop_pending_ && buffer.stop_is_due()) {
      finish_stop(buffer);
    } else if (buffer.empty()) {
      return;
    } else if (receive(buffer.take())) {
      scan(buffer);
    } else {
      continue;  // most bytes: nothing was sent
    }
    room = hal::transmit_room() >= REPLY_ROOM;
  }
}

inline void Machine::scan(ReceiveBuffer &buffer) {
  if (buffer.find_candidate() || buffer.too_full()) act_on_stops(buffer);
}

__attribute__((noinline)) void Machine::act_on_stops(ReceiveBuffer &buffer) {
  uint8_t type, seq;
  while (buffer.find_stop(&type, &seq)) {
    execute(type, 0, 0);
    buffer.add_stop(type, seq);
    stop_pending_ = true;
    if (type == FRAME_EMERGENCY_STOP) emergency_pending_ = true;
  }
  if (buffer.discard_oldest()) receiver_.feed(0);
}

// Remove the first early stop. If its frame was discarded, and so not decoded, carry it out again and acknowledge it.
__attribute__((noinline)) void Machine::finish_stop(ReceiveBuffer &buffer) {
  EarlyStop stop = buffer.first_stop();
  buffer.remove_stop();
  stop_pending_ = buffer.has_stops();
  emergency_pending_ = buffer.has_emergency();
  if (!stop.lost) return;
  restart_host_timeout();
  send_ack(stop.type, stop.seq, execute(stop.type, 0, 0));
}

// Decode a byte; return true if it ended a line or a frame, whose handling takes long.
bool Machine::receive(uint8_t byte) {
  byte_received_ = true;
  Received received = receiver_.feed(byte);
  if (received == RECEIVED_NOTHING) return false;
  handle(received);
  return true;
}

// Not inlined: otherwise every byte would need the stack space of this function.
__attribute__((noinline)) void Machine::handle(Received received) {
  if (received == RECEIVED_LINE) text_.take(*this, receiver_.line(), receiver_.line_size());
  if (received != RECEIVED_FRAME || receiver_.type() >= REQUEST_END) return;
  restart_host_timeout();
  handle_frame();
}

void Machine::restart_host_timeout() {
  TickDisabled disabled;
  host_silence_ = 0;
}

void Machine::handle_frame() {
  if (receiver_.type() == FRAME_HELLO && receiver_.size() == 0) {
    send_hello(receiver_.seq());
    return;
  }
  Error error = execute(receiver_.type(), receiver_.payload(), receiver_.size());
  send_ack(receiver_.type(), receiver_.seq(), error);
  if (error == ERROR_OK && (receiver_.type() == FRAME_MOVE || receiver_.type() == FRAME_MOVE_STRAIGHT)) {
    make_move(receiver_.type(), receiver_.payload(), receiver_.size());
  }
}

void Machine::send_ack(uint8_t type, uint8_t seq, Error error) {
  Ack ack;
  ack.error = error;
  uint8_t payload[Ack::SIZE];
  ack.write(payload);
  send(uint8_t(type | REPLY_BIT), seq, payload, Ack::SIZE);
}

// Without a host, text motions need no heartbeat: a program that opens the port itself sends none.
void Machine::tick() {
  tick_++;
  if (host_silence_ < HOST_GONE) host_silence_++;
  if (host_silence_ >= HEARTBEAT_TIMEOUT && (host_silence_ < HOST_GONE || motion_number_ != TEXT_MOTION)) {
    motion_.brake(OUTCOME_HOST_LOST);
  }
  motion_.tick();
}

void Machine::poll() {
  hal::reset_watchdog();
  uint16_t tick, silence;
  {
    TickDisabled disabled;
    tick = uint16_t(tick_);
    silence = host_silence_;
  }
  check_timeouts(tick, silence);
  text_.poll(*this);
  if (silence < HOST_GONE && !reply_expected(tick)) send_telemetry();
}

// Return whether TELEMETRY waits, at most for TELEMETRY_PATIENCE, so as not to delay the reply to an arriving request.
bool Machine::reply_expected(uint16_t tick) const {
  return receiver_.in_frame() && uint16_t(tick - byte_tick_) <= 1 &&
         uint16_t(tick - reported_.tick) < TELEMETRY_PERIOD + TELEMETRY_PATIENCE;
}

void Machine::check_timeouts(uint16_t tick, uint16_t silence) {
  if (byte_received_) {
    byte_received_ = false;
    byte_tick_ = tick;
  } else if (uint16_t(tick - byte_tick_) >= TEXT_LINE_TIMEOUT) {
    byte_tick_ = tick;
    receiver_.abandon();
  }
  // The host that forwarded the lines is gone, so a client could not stop their motions.
  if (silence >= HEARTBEAT_TIMEOUT && silence < HOST_GONE) text_.cancel_motions();
}

bool Machine::has_host() const {
  TickDisabled disabled;
  return host_silence_ < HOST_GONE;
}

// Replies have priority: telemetry is sent only while a reply still fits, otherwise at a later poll().
void Machine::send_telemetry() {
  if (!telemetry_due() || hal::transmit_room() < Telemetry::SIZE + WIRE_OVERHEAD + REPLY_ROOM) return;
  reported_ = current_telemetry();
  uint8_t payload[Telemetry::SIZE];
  reported_.write(payload);
  send(FRAME_TELEMETRY, telemetry_seq_++, payload, Telemetry::SIZE);
}

bool Machine::telemetry_due() const {
  TickDisabled disabled;
  return state() != reported_.state || motion_.outcome() != reported_.outcome || motion_number_ != reported_.motion ||
         uint16_t(uint16_t(tick_) - reported_.tick) >= TELEMETRY_PERIOD;
}

Telemetry Machine::current_telemetry() const {
  TickDisabled disabled;
  Telemetry now;
  now.tick = uint16_t(tick_);
  now.boot = uint8_t(hal::boot_number());
  now.state = state();
  now.outcome = motion_.outcome();
  now.motion = motion_number_;
  for (uint8_t i = 0; i < ARMS; i++) {
    now.position[i] = int16_t(motion_.axis(i).steps());
    now.velocity[i] = to_rate(motion_.axis(i).velocity());
  }
  now.rejected = receiver_.rejected();
  now.overflowed = hal::bytes_lost();
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

void Machine::send_text(const char *line, bool last) {
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

// Sent only to hosts, because the text protocol has no warnings.
void Machine::send_text_warning(uint8_t code) {
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
