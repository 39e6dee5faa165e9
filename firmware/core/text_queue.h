// Lines of text that wait for their turn. Nothing is lost and nothing changes places: answers come in the order of
// the lines, those of lines that found no room as well.
#ifndef BEATRIX_TEXT_QUEUE_H
#define BEATRIX_TEXT_QUEUE_H

#include "text_order.h"

namespace beatrix {

class TextQueue {
 public:
  bool empty() const { return used_ == 0; }
  void clear() { used_ = 0; }

  // False: no room, and the order is answered ACK NACK in its turn.
  bool put(const Order &order) {
    if (order.light()) {
      put_light(order);
      return true;
    }
    if (used_ >= ORDERS) {
      put_light(plain_order(VERB_REFUSED));
      return false;
    }
    append(order);
    return true;
  }

  // Only while not empty.
  Order take() {
    Order &first = slots_[first_];
    Order order = first;
    order.more = 0;
    if (first.more) {
      first.more--;
    } else {
      first_ = uint8_t((first_ + 1) % SLOTS);
      used_--;
    }
    return order;
  }

  // Moves that wait will not be made.
  void call_off() {
    for (uint8_t i = 0; i < used_; i++) {
      Order &order = slots_[(first_ + i) % SLOTS];
      if (order.moves()) order.verb = VERB_REFUSED;
    }
  }

 private:
  static const uint8_t SLOTS = 64;
  static const uint8_t ORDERS = 32;  // the other slots are for light ones that come when these are full
  static const uint16_t MORE_MAX = 0xFFFF;

  // If after dozens of changes between kinds of light ones no slot is left either, it is answered like the last one.
  void put_light(const Order &order) {
    Order &last = slots_[(first_ + used_ + SLOTS - 1) % SLOTS];
    bool same = used_ && last.verb == order.verb && last.more < MORE_MAX;
    if (!same && used_ < SLOTS) {
      append(order);
    } else if (last.more < MORE_MAX) {
      last.more++;
    }
  }

  void append(const Order &order) {
    slots_[(first_ + used_) % SLOTS] = order;
    used_++;
  }

  Order slots_[SLOTS] = {};
  uint8_t first_ = 0;
  uint8_t used_ = 0;
};

}  // namespace beatrix

#endif
