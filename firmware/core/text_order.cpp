// The words of the old text protocol, and how their arguments are read.
#include "text_order.h"

namespace beatrix {

static const uint8_t WORDS_MAX = 20;
static const uint8_t WORD_MAX = 19;
static const int32_t STEPS_MAX = 32767;
static const int32_t BEYOND = 100000;  // where reading a number ends: too large anyway

namespace {

struct Word {
  const uint8_t *text;
  uint8_t size;

  bool is(const char *other) const {
    uint8_t i = 0;
    while (i < size && other[i] == text[i]) i++;  // `other` ends with 0, which no word contains
    return i == size && other[i] == 0;
  }
};

// Words are one space apart: two spaces have an empty word between them.
class Words {
 public:
  Words(const uint8_t *line, uint8_t size) : at_(line), left_(size) {}

  // Past the end: an empty one.
  Word next() {
    Word word = {at_, 0};
    while (left_ && *at_ != ' ') {
      word.size++;
      step();
    }
    if (left_) step();
    return word;
  }

 private:
  void step() {
    at_++;
    left_--;
  }

  const uint8_t *at_;
  uint8_t left_;
};

enum Arguments : uint8_t { STEPS_OF_X, STEPS_OF_Y, STEPS_OF_Z, STEPS_OF_ALL, TURN_AND_TILT, SWITCH, NONE };

struct Known {
  char word[11];
  Verb verb;
  Arguments arguments;
};

const Known KNOWN[] = {
    {"@ENMOTORS", VERB_MOTORS_ON, SWITCH},
    {"@CALNOW", VERB_CALIBRATE, NONE},
    {"@CALSTATUS", VERB_ASK_CALIBRATED, NONE},
    {"@COMSTATUS", VERB_ASK_ALIVE, NONE},
    {"@MOVHOME", VERB_MOVE_TO, NONE},
    {"@MOVRX", VERB_MOVE_BY, STEPS_OF_X},
    {"@MOVRY", VERB_MOVE_BY, STEPS_OF_Y},
    {"@MOVRZ", VERB_MOVE_BY, STEPS_OF_Z},
    {"@MOVAX", VERB_MOVE_X_TO, STEPS_OF_X},
    {"@MOVAY", VERB_MOVE_Y_TO, STEPS_OF_Y},
    {"@MOVAZ", VERB_MOVE_Z_TO, STEPS_OF_Z},
    {"@MOVRALL", VERB_MOVE_BY, STEPS_OF_ALL},
    {"@MOVAALL", VERB_MOVE_TO, STEPS_OF_ALL},
    {"@MOVTORPOS", VERB_MOVE_BY, TURN_AND_TILT},
    {"@MOVTOAPOS", VERB_MOVE_TO, TURN_AND_TILT},
    {"@STOPALL", VERB_STOP, NONE},
    {"@GETXPOS", VERB_ASK_X, NONE},
    {"@GETYPOS", VERB_ASK_Y, NONE},
    {"@GETZPOS", VERB_ASK_Z, NONE},
    {"@GETALLPOS", VERB_ASK_ALL, NONE},
    {"@CALSTART", VERB_REFUSED, NONE},
    {"@CALEND", VERB_REFUSED, NONE},
    {"@CALX", VERB_REFUSED, NONE},
    {"@CALY", VERB_REFUSED, NONE},
    {"@CALZ", VERB_REFUSED, NONE},
};

bool within_limits(const uint8_t *line, uint8_t size) {
  if (size > TEXT_LINE_MAX) return false;
  uint8_t words = 1, length = 0;
  for (uint8_t i = 0; i < size; i++) {
    if (line[i] != ' ') {
      if (++length > WORD_MAX) return false;
    } else {
      length = 0;
      if (i + 1 < size && ++words > WORDS_MAX) return false;
    }
  }
  return true;
}

// Words without arguments are known when the line ends with them, the others when a space follows.
const Known *find(const Word &word, uint8_t line_size) {
  bool alone = word.size == line_size;
  for (uint8_t i = 0; i < sizeof KNOWN / sizeof KNOWN[0]; i++) {
    if (word.is(KNOWN[i].word)) return (KNOWN[i].arguments == NONE) == alone ? &KNOWN[i] : 0;
  }
  return 0;
}

// As C's atoi: a sign, digits, up to the first other character; nothing there is 0.
int32_t number(const Word &word) {
  uint8_t at = 0;
  bool negative = word.size && word.text[0] == '-';
  if (word.size && (word.text[0] == '-' || word.text[0] == '+')) at = 1;
  int32_t value = 0;
  for (; at < word.size && word.text[at] >= '0' && word.text[at] <= '9'; at++) {
    if (value < BEYOND) value = value * 10 + (word.text[at] - '0');
  }
  return negative ? -value : value;
}

bool fits(int32_t steps) { return steps <= STEPS_MAX && steps >= -STEPS_MAX; }

// The extension of one laboratory: a common turn and a tilt over the short arm. False: out of range.
bool turn_and_tilt(Words &words, int32_t steps[ARMS]) {
  int32_t turn = number(words.next()), tilt = number(words.next());
  steps[0] = turn + tilt;
  steps[1] = turn - 2 * tilt / 3;
  steps[2] = turn - tilt / 3;
  return fits(turn) && fits(tilt);
}

bool read_steps(Words &words, Arguments arguments, int32_t steps[ARMS]) {
  if (arguments == TURN_AND_TILT) return turn_and_tilt(words, steps);
  if (arguments <= STEPS_OF_Z) {
    steps[arguments] = number(words.next());
  } else if (arguments == STEPS_OF_ALL) {
    for (uint8_t i = 0; i < ARMS; i++) steps[i] = number(words.next());
  }
  return true;
}

Verb read_switch(const Word &word) {
  return word.is("ON") ? VERB_MOTORS_ON : word.is("OFF") ? VERB_MOTORS_OFF : VERB_REFUSED;
}

}  // namespace

Order read_order(const uint8_t *line, uint8_t size) {
  Order order = plain_order(VERB_UNKNOWN);
  if (!within_limits(line, size)) return order;
  Words words(line, size);
  const Known *known = find(words.next(), size);
  if (!known) return order;
  order.verb = known->verb;
  if (known->arguments == SWITCH) {
    order.verb = read_switch(words.next());
    return order;
  }
  int32_t steps[ARMS] = {0, 0, 0};
  bool good = read_steps(words, known->arguments, steps);
  for (uint8_t i = 0; i < ARMS; i++) {
    if (!fits(steps[i])) good = false;
    order.steps[i] = int16_t(steps[i]);
  }
  return good ? order : plain_order(VERB_REFUSED);
}

}  // namespace beatrix
