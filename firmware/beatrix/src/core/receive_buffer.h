// Ring buffer of received bytes. A stop frame is carried out when it is found there, before the bytes ahead of it.
//
// put() runs in the AVR's receive interrupt, everything else in the main loop. Each variable is written on one side
// only, so neither side disables interrupts.
//
// The main loop scans new bytes for stop frames (find_stop) before and after every long action. It discards the oldest
// bytes beyond FILL_MAX (discard_oldest), so all bytes fit until the next scan, and no stop frame is lost.
#ifndef BEATRIX_RECEIVE_BUFFER_H
#define BEATRIX_RECEIVE_BUFFER_H

#include "frame.h"

namespace beatrix {

// A stop frame that was carried out before the bytes ahead of it were read.
struct EarlyStop {
  uint8_t end;  // its end in the ring
  uint8_t type;
  uint8_t seq;
  bool lost;  // discarded with other bytes: the receiver will not decode it
};

class ReceiveBuffer {
 public:
  // Add a received byte.
  void put(uint8_t byte) {
    uint8_t head = head_;
    uint8_t next = uint8_t(head + 1);
    if (next == tail_) {
      overruns_++;
      return;
    }
    bytes_[head] = byte;
    head_ = next;
  }

  bool empty() const { return head_ == tail_; }
  bool full() const { return waiting() >= FILL_MAX; }
  bool too_full() const { return waiting() > FILL_MAX; }
  // Remove and return the oldest byte; the buffer must not be empty.
  uint8_t take() {
    uint8_t tail = tail_;
    uint8_t byte = bytes_[tail];
    tail_ = uint8_t(tail + 1);
    return byte;
  }

  bool has_unscanned() const { return scanned_ != head_; }
  // Scan new bytes up to a delimiter that may end a stop frame; return false if there is none. Inlined, because it runs
  // for every byte: a call is then needed only for a possible stop frame.
  inline bool find_candidate();
  // Scan new bytes up to the end of the next stop frame; return false if there is none.
  bool find_stop(uint8_t *type, uint8_t *seq);
  // Store the frame just found. If the list is full, it replaces the newest frame, whose request the host repeats; the
  // entry is an EMERGENCY_STOP if either frame is one.
  void add_stop(uint8_t type, uint8_t seq);
  // Discard the oldest lines and frames beyond FILL_MAX, even an incomplete one; return whether any was discarded.
  bool discard_oldest();
  // Return the number of bytes lost or discarded since start, at most 255.
  uint8_t bytes_lost() const { return at_most_255(uint16_t(overruns_ + discarded_)); }

  // Return whether any stop frame was executed early, and the bytes before it have not been read yet.
  bool has_stops() const { return stop_count_ != 0; }
  bool has_emergency() const;
  // Return whether the main loop has read all bytes up to the end of the first stop frame, or has discarded the frame.
  bool stop_is_due() const { return stop_count_ && (stops_[first_].lost || stops_[first_].end == tail_); }
  const EarlyStop &first_stop() const { return stops_[first_]; }
  void remove_stop() {
    first_ = uint8_t((first_ + 1) % STOPS);
    stop_count_--;
  }

 private:
  static const uint8_t FILL_MAX = 191;  // leaves 64 bytes, 2.5 ms
  static const uint8_t STOPS = 16;
  // Lengths of blocks are counted up to this value, because the start of a longer block may be overwritten.
  static const uint8_t BLOCK_LONG = STOP_BLOCK + 2;

  static uint8_t at_most_255(uint16_t count) { return uint8_t(count > 255 ? 255 : count); }
  bool within_stop(uint8_t at) const;
  uint8_t waiting() const { return uint8_t(head_ - tail_); }

  // Written by put().
  volatile uint8_t head_ = 0;
  volatile uint8_t overruns_ = 0;  // 0 while the main loop keeps its budget (hal.h)
  // Written by the main loop.
  volatile uint8_t tail_ = 0;
  uint8_t scanned_ = 0;  // end of the scanned bytes
  // Start of the block being scanned. Bytes before the first delimiter count as a long block.
  uint8_t block_ = uint8_t(-BLOCK_LONG);
  uint8_t discarded_ = 0;
  uint8_t first_ = 0;
  uint8_t stop_count_ = 0;
  EarlyStop stops_[STOPS] = {};
  uint8_t bytes_[256] = {};  // indices wrap by themselves
};

static_assert(FRAME_EMERGENCY_STOP == (FRAME_STOP | 1) && !(FRAME_STOP & 1), "one comparison finds both");

bool ReceiveBuffer::find_candidate() {
  uint8_t scanned = scanned_, block = block_;
  const uint8_t head = head_;
  bool found = false;
  for (; scanned != head; scanned++) {
    if (bytes_[scanned]) continue;
    found = uint8_t(scanned - block) == STOP_BLOCK && (bytes_[uint8_t(block + 1)] | 1) == FRAME_EMERGENCY_STOP;
    if (found) break;
    block = uint8_t(scanned + 1);
  }
  scanned_ = scanned;
  block_ = uint8_t(scanned - block) > BLOCK_LONG ? uint8_t(scanned - BLOCK_LONG) : block;
  return found;
}

}  // namespace beatrix

#endif
