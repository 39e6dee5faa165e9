// Queue of text commands. Replies keep the order of the lines, also of lines that arrive when the queue is full.
#ifndef BEATRIX_TEXT_QUEUE_H
#define BEATRIX_TEXT_QUEUE_H

#include "text_command.h"

namespace beatrix {

class TextQueue {
 public:
  bool empty() const { return used_ == 0; }
  void clear() { used_ = 0; }

  // Append a command; return false if the queue is full, in which case the answer will be ACK NACK.
  bool put(const TextCommand &command) {
    if (command.repeatable()) {
      put_repeatable(command);
      return true;
    }
    if (used_ >= COMMANDS) {
      put_repeatable(command_of_kind(COMMAND_REFUSED));
      return false;
    }
    append(command);
    return true;
  }

  // Remove and return the first command; the queue must not be empty.
  TextCommand take() {
    TextCommand &first = slots_[first_];
    TextCommand command = first;
    command.repeats = 0;
    if (first.repeats) {
      first.repeats--;
    } else {
      first_ = uint8_t((first_ + 1) % SLOTS);
      used_--;
    }
    return command;
  }

  // Refuse the queued motions.
  void cancel_motions() {
    for (uint8_t i = 0; i < used_; i++) {
      TextCommand &command = slots_[(first_ + i) % SLOTS];
      if (command.is_motion()) command.kind = COMMAND_REFUSED;
    }
  }

 private:
  static const uint8_t SLOTS = 64;
  static const uint8_t COMMANDS = 32;  // the other slots are for repeatable commands
  static const uint16_t REPEATS_MAX = 0xFFFF;

  // If all slots are full (dozens of commands of alternating kinds), the command gets the answer of the last command.
  void put_repeatable(const TextCommand &command) {
    TextCommand &last = slots_[(first_ + used_ + SLOTS - 1) % SLOTS];
    bool same = used_ && last.kind == command.kind && last.repeats < REPEATS_MAX;
    if (!same && used_ < SLOTS) {
      append(command);
    } else if (last.repeats < REPEATS_MAX) {
      last.repeats++;
    }
  }

  void append(const TextCommand &command) {
    slots_[(first_ + used_) % SLOTS] = command;
    used_++;
  }

  TextCommand slots_[SLOTS] = {};
  uint8_t first_ = 0;
  uint8_t used_ = 0;
};

}  // namespace beatrix

#endif
