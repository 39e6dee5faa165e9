// One line of the old text protocol, understood.
#ifndef BEATRIX_TEXT_ORDER_H
#define BEATRIX_TEXT_ORDER_H

#include "guard.h"

namespace beatrix {

enum Verb : uint8_t {
  // Answers without a deed: of many such lines in a row only the number is kept.
  VERB_UNKNOWN,  // NACK
  VERB_REFUSED,  // ACK NACK: reserved words, bad arguments, moves called off, no room to wait
  VERB_STOP,     // ACK ACK: has acted already when the line came
  VERB_LAST_LIGHT = VERB_STOP,

  VERB_MOVE_BY,
  VERB_MOVE_TO,
  VERB_MOVE_X_TO,  // and for Y and Z the next two: the other arms stay
  VERB_MOVE_Y_TO,
  VERB_MOVE_Z_TO,
  VERB_LAST_MOVE = VERB_MOVE_Z_TO,

  VERB_MOTORS_ON,
  VERB_MOTORS_OFF,
  VERB_CALIBRATE,
  VERB_ASK_CALIBRATED,
  VERB_ASK_ALIVE,
  VERB_ASK_X,  // and for Y and Z the next two
  VERB_ASK_Y,
  VERB_ASK_Z,
  VERB_ASK_ALL,
};

struct Order {
  Verb verb;
  uint16_t more;        // light verbs: as many further ones follow
  int16_t steps[ARMS];  // moves: by or to; 0 where the line says nothing

  bool light() const { return verb <= VERB_LAST_LIGHT; }
  bool moves() const { return verb >= VERB_MOVE_BY && verb <= VERB_LAST_MOVE; }
};

constexpr Order plain_order(Verb verb) { return {verb, 0, {0, 0, 0}}; }

// A line without its end; of one longer than TEXT_LINE_MAX only the size counts.
Order read_order(const uint8_t *line, uint8_t size);

}  // namespace beatrix

#endif
