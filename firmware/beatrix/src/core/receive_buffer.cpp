// Ring buffer of received bytes.
#include "../speed.h"
#include "receive_buffer.h"

namespace beatrix {

// The bytes of a block that has just ended can be copied: they are still in the ring, even if they have been read.
bool ReceiveBuffer::find_stop(uint8_t *type, uint8_t *seq) {
  bool found = false;
  while (!found && find_candidate()) {
    uint8_t copy[STOP_BLOCK];
    for (uint8_t i = 0; i < STOP_BLOCK; i++) copy[i] = bytes_[uint8_t(block_ + i)];
    found = read_stop(copy, type, seq);
    block_ = ++scanned_;
  }
  return found;
}

void ReceiveBuffer::add_stop(uint8_t type, uint8_t seq) {
  bool emergency = false;
  if (stop_count_ == STOPS) {
    stop_count_--;
    emergency = stops_[uint8_t(first_ + stop_count_) % STOPS].type == FRAME_EMERGENCY_STOP;
  }
  EarlyStop &last = stops_[uint8_t(first_ + stop_count_) % STOPS];
  last.end = scanned_;
  last.type = emergency ? uint8_t(FRAME_EMERGENCY_STOP) : type;
  last.seq = seq;
  last.lost = false;
  stop_count_++;
}

bool ReceiveBuffer::within_stop(uint8_t at) const {
  for (uint8_t i = 0; i < stop_count_; i++) {
    uint8_t left = uint8_t(stops_[uint8_t(first_ + i) % STOPS].end - at);
    if (left > 0 && left <= STOP_BLOCK) return true;
  }
  return false;
}

// Discard up to the end of a frame or line, and mark stop frames among the discarded bytes as lost.
bool ReceiveBuffer::discard_oldest() {
  if (!too_full()) return false;
  uint8_t tail = tail_, discarded = 0, excess = uint8_t(waiting() - FILL_MAX);
  bool ends = false;
  while (tail != scanned_ && (discarded < excess || !ends)) {
    uint8_t byte = bytes_[tail++];
    discarded++;
    ends = byte == 0 || ((byte == '\r' || byte == '\n') && !within_stop(tail));
    for (uint8_t i = 0; i < stop_count_; i++) {
      EarlyStop &stop = stops_[uint8_t(first_ + i) % STOPS];
      if (stop.end == tail) stop.lost = true;
    }
  }
  tail_ = tail;
  discarded_ = at_most_255(uint16_t(discarded_ + discarded));
  return true;
}

bool ReceiveBuffer::has_emergency() const {
  for (uint8_t i = 0; i < stop_count_; i++) {
    if (stops_[uint8_t(first_ + i) % STOPS].type == FRAME_EMERGENCY_STOP) return true;
  }
  return false;
}

}  // namespace beatrix
