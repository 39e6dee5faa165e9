// Parser for a line of the text protocol of 2023.
#ifndef BEATRIX_TEXT_COMMAND_H
#define BEATRIX_TEXT_COMMAND_H

#include "limits.h"

namespace beatrix {

enum CommandKind : uint8_t {
  // Commands that need only a reply; the queue counts equal ones in a row instead of storing each.
  COMMAND_UNKNOWN,  // NACK
  COMMAND_REFUSED,  // ACK NACK: reserved words, bad arguments, cancelled motions, full queue
  COMMAND_STOP,     // ACK ACK: carried out when its line arrives
  COMMAND_LAST_REPEATABLE = COMMAND_STOP,

  COMMAND_MOVE_BY,
  COMMAND_MOVE_TO,
  COMMAND_MOVE_X_TO,  // X, Y, Z in this order: the other arms keep their targets
  COMMAND_MOVE_Y_TO,
  COMMAND_MOVE_Z_TO,
  COMMAND_LAST_MOVE = COMMAND_MOVE_Z_TO,

  COMMAND_MOTORS_ON,
  COMMAND_MOTORS_OFF,
  COMMAND_CALIBRATE,
  COMMAND_GET_CALIBRATED,
  COMMAND_GET_CONNECTED,
  COMMAND_GET_X,  // X, Y, Z in this order
  COMMAND_GET_Y,
  COMMAND_GET_Z,
  COMMAND_GET_ALL,
};

struct TextCommand {
  CommandKind kind;
  uint16_t repeats;        // repeatable commands: number of repetitions after the first
  int16_t steps[ARMS];  // motions: distance or target; 0 if the line has none

  bool repeatable() const { return kind <= COMMAND_LAST_REPEATABLE; }
  bool is_motion() const { return kind >= COMMAND_MOVE_BY && kind <= COMMAND_LAST_MOVE; }
};

constexpr TextCommand command_of_kind(CommandKind kind) { return {kind, 0, {0, 0, 0}}; }

// Return the command of a line without its line end; COMMAND_UNKNOWN if the word is unknown or the line too long.
TextCommand parse_command(const uint8_t *line, uint8_t size);

}  // namespace beatrix

#endif
