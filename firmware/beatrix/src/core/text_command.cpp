// Words and arguments of the text protocol of 2023.
#include "../speed.h"
#include "text_command.h"

namespace beatrix {

static const uint8_t WORDS_MAX = 20;
static const uint8_t WORD_MAX = 19;
static const int32_t STEPS_MAX = 32767;
static const int32_t BEYOND = 100000;  // no digits are added to numbers from here on

namespace {

struct Word {
  const uint8_t *text;
  uint8_t size;

  bool is(const char *other) const {
    uint8_t i = 0;
    while (i < size && other[i] == text[i]) i++;  // `other` ends with 0, which a word never contains
    return i == size && other[i] == 0;
  }
};

// Words are separated by one space; two spaces enclose an empty word.
class WordReader {
 public:
  WordReader(const uint8_t *line, uint8_t size) : at_(line), left_(size) {}

  // Return the next word, or an empty word after the end.
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

enum Arguments : uint8_t { STEPS_OF_X, STEPS_OF_Y, STEPS_OF_Z, STEPS_OF_ALL, TURN_AND_TILT, ON_OR_OFF, NONE };

struct KnownWord {
  char word[11];
  CommandKind kind;
  Arguments arguments;
};

const KnownWord KNOWN_WORDS[] = {
    {"@ENMOTORS", COMMAND_MOTORS_ON, ON_OR_OFF},
    {"@CALNOW", COMMAND_CALIBRATE, NONE},
    {"@CALSTATUS", COMMAND_GET_CALIBRATED, NONE},
    {"@COMSTATUS", COMMAND_GET_CONNECTED, NONE},
    {"@MOVHOME", COMMAND_MOVE_TO, NONE},
    {"@MOVRX", COMMAND_MOVE_BY, STEPS_OF_X},
    {"@MOVRY", COMMAND_MOVE_BY, STEPS_OF_Y},
    {"@MOVRZ", COMMAND_MOVE_BY, STEPS_OF_Z},
    {"@MOVAX", COMMAND_MOVE_X_TO, STEPS_OF_X},
    {"@MOVAY", COMMAND_MOVE_Y_TO, STEPS_OF_Y},
    {"@MOVAZ", COMMAND_MOVE_Z_TO, STEPS_OF_Z},
    {"@MOVRALL", COMMAND_MOVE_BY, STEPS_OF_ALL},
    {"@MOVAALL", COMMAND_MOVE_TO, STEPS_OF_ALL},
    {"@MOVTORPOS", COMMAND_MOVE_BY, TURN_AND_TILT},
    {"@MOVTOAPOS", COMMAND_MOVE_TO, TURN_AND_TILT},
    {"@STOPALL", COMMAND_STOP, NONE},
    {"@GETXPOS", COMMAND_GET_X, NONE},
    {"@GETYPOS", COMMAND_GET_Y, NONE},
    {"@GETZPOS", COMMAND_GET_Z, NONE},
    {"@GETALLPOS", COMMAND_GET_ALL, NONE},
    {"@CALSTART", COMMAND_REFUSED, NONE},
    {"@CALEND", COMMAND_REFUSED, NONE},
    {"@CALX", COMMAND_REFUSED, NONE},
    {"@CALY", COMMAND_REFUSED, NONE},
    {"@CALZ", COMMAND_REFUSED, NONE},
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

// A word without arguments must end the line; any other must be followed by a space.
const KnownWord *find(const Word &word, uint8_t line_size) {
  bool alone = word.size == line_size;
  for (uint8_t i = 0; i < sizeof KNOWN_WORDS / sizeof KNOWN_WORDS[0]; i++) {
    if (word.is(KNOWN_WORDS[i].word)) return (KNOWN_WORDS[i].arguments == NONE) == alone ? &KNOWN_WORDS[i] : 0;
  }
  return 0;
}

// Return a number like atoi() of C: a sign and digits up to the first other character; 0 without digits.
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

// Extension of one laboratory: turn all arms, and tilt the head over the short arm.
// Return false if an argument is out of range.
bool turn_and_tilt(WordReader &words, int32_t steps[ARMS]) {
  int32_t turn = number(words.next()), tilt = number(words.next());
  steps[0] = turn + tilt;
  steps[1] = turn - 2 * tilt / 3;
  steps[2] = turn - tilt / 3;
  return fits(turn) && fits(tilt);
}

bool read_steps(WordReader &words, Arguments arguments, int32_t steps[ARMS]) {
  if (arguments == TURN_AND_TILT) return turn_and_tilt(words, steps);
  if (arguments <= STEPS_OF_Z) {
    steps[arguments] = number(words.next());
  } else if (arguments == STEPS_OF_ALL) {
    for (uint8_t i = 0; i < ARMS; i++) steps[i] = number(words.next());
  }
  return true;
}

CommandKind read_switch(const Word &word) {
  return word.is("ON") ? COMMAND_MOTORS_ON : word.is("OFF") ? COMMAND_MOTORS_OFF : COMMAND_REFUSED;
}

}  // namespace

TextCommand parse_command(const uint8_t *line, uint8_t size) {
  TextCommand command = command_of_kind(COMMAND_UNKNOWN);
  if (!within_limits(line, size)) return command;
  WordReader words(line, size);
  const KnownWord *known = find(words.next(), size);
  if (!known) return command;
  command.kind = known->kind;
  if (known->arguments == ON_OR_OFF) {
    command.kind = read_switch(words.next());
    return command;
  }
  int32_t steps[ARMS] = {0, 0, 0};
  bool good = read_steps(words, known->arguments, steps);
  for (uint8_t i = 0; i < ARMS; i++) {
    if (!fits(steps[i])) good = false;
    command.steps[i] = int16_t(steps[i]);
  }
  return good ? command : command_of_kind(COMMAND_REFUSED);
}

}  // namespace beatrix
