// Fuzz target: bytes, frames and lines of every kind, in any order, with time between them.
//
// The input is a list of operations: a byte for the kind, a byte for a parameter, and the data.
#include <stddef.h>

#include "../beatrix/src/core/frame.h"
#include "../beatrix/src/core/limits.h"
#include "board.h"

namespace {

class Input {
 public:
  Input(const uint8_t *data, size_t size) : data_(data), left_(size) {}

  bool empty() const { return left_ == 0; }
  // Return the next byte, or 0 after the end.
  uint8_t next() {
    if (empty()) return 0;
    left_--;
    return *data_++;
  }

 private:
  const uint8_t *data_;
  size_t left_;
};

void send_bytes(const uint8_t *bytes, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) receive_buffer()[i] = bytes[i];
  receive(count);
  drain();
}

void send_noise(Input &input, uint8_t count) {
  uint8_t noise[255];
  for (uint8_t i = 0; i < count; i++) noise[i] = input.next();
  send_bytes(noise, count);
}

void send_frame(uint8_t type, const uint8_t *payload, uint8_t size) {
  uint8_t wire[beatrix::MAX_WIRE];
  send_bytes(wire, beatrix::encode(type, 0, payload, size, wire));
}

// Send a correct frame of an existing type, or of a type near it.
void send_any_frame(Input &input, uint8_t how) {
  uint8_t payload[beatrix::MAX_PAYLOAD];
  uint8_t size = uint8_t(input.next() % (beatrix::MAX_PAYLOAD + 1));
  for (uint8_t i = 0; i < size; i++) payload[i] = input.next();
  send_frame(uint8_t(how % 13), payload, size);
}

// Send a move with mostly valid fields.
void send_move(Input &input, uint8_t how) {
  beatrix::Move move;
  move.motion = input.next();
  for (uint8_t i = 0; i < beatrix::ARMS; i++) {
    move.target[i] = int16_t((input.next() - 128) * (how & 2 ? 24 : 3) + (how >> 4));
    move.speed[i] = uint16_t(input.next() * 17);
  }
  uint8_t payload[beatrix::Move::SIZE];
  move.write(payload);
  // MOVE_STRAIGHT has one speed only, and otherwise the same fields.
  if (how & 1) send_frame(beatrix::FRAME_MOVE_STRAIGHT, payload, beatrix::MoveStraight::SIZE);
  else send_frame(beatrix::FRAME_MOVE, payload, beatrix::Move::SIZE);
}

// Run ticks; trap if the arms exceed the limits, or if arm X makes a step while the motors are off.
void run_checked(uint8_t milliseconds) {
  const Report *report = report_buffer();
  for (uint8_t i = 0; i < milliseconds; i++) {
    int32_t before = report->pulses[0];
    bool could_turn = report->drivers_on;
    tick(1);
    if (beatrix::check_steps(report->steps) != beatrix::OUTCOME_NONE) __builtin_trap();
    if (!could_turn && report->pulses[0] != before) __builtin_trap();
  }
  drain();
}

// Send a line of text with a known or unknown word and arguments of any bytes.
void send_line(Input &input, uint8_t how) {
  static const char *const WORDS[] = {"@ENMOTORS ON", "@ENMOTORS OFF", "@CALNOW", "@STOPALL", "@GETALLPOS", "@GETXPOS",
                                      "@MOVHOME", "@MOVRALL ", "@MOVAALL ", "@MOVRX ", "@MOVAY ", "@MOVTOAPOS ", "@"};
  uint8_t line[192];
  uint8_t size = 0;
  for (const char *at = WORDS[how % (sizeof WORDS / sizeof WORDS[0])]; *at; at++) line[size++] = uint8_t(*at);
  for (uint8_t left = how & 0x80 ? input.next() % 150 : how / 13; left; left--) line[size++] = input.next();
  line[size++] = how & 1 ? '\r' : '\n';
  send_bytes(line, size);
}

// Send a text motion with mostly valid numbers.
void send_text_move(Input &input, uint8_t how) {
  uint8_t line[32] = "@MOVRALL +000 +000 +000\r";
  if (how & 1) line[4] = 'A';
  for (uint8_t i = 0; i < beatrix::ARMS; i++) {
    uint8_t *number = line + 9 + 5 * i;
    uint8_t digits = input.next();
    number[0] = digits & 1 ? '-' : '+';
    number[1] = uint8_t('0' + digits % 10);
    number[2] = uint8_t('0' + digits / 10 % 10);
    number[3] = uint8_t('0' + digits / 26);
  }
  send_bytes(line, 24);
}

void enable_and_calibrate() {
  const uint8_t on = 1;
  send_frame(beatrix::FRAME_ENABLE, &on, 1);
  send_frame(beatrix::FRAME_CALIBRATE, &on, 0);
}

void enable_and_calibrate_in_text() {
  const uint8_t lines[] = "@ENMOTORS ON\r@CALNOW\r";
  send_bytes(lines, sizeof lines - 1);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  start(1);
  Input input(data, size);
  while (!input.empty()) {
    uint8_t what = input.next(), how = input.next();
    switch (what % 8) {
      case 0: send_noise(input, how); break;
      case 1: send_any_frame(input, how); break;
      case 2: send_move(input, how); break;
      case 3: enable_and_calibrate(); break;
      case 4: run_checked(how); break;
      case 5: send_line(input, how); break;
      case 6: send_text_move(input, how); break;
      case 7: enable_and_calibrate_in_text(); break;
    }
  }
  return 0;
}
