// Frames of the serial link.
#include "frame.h"

#include "crc.h"

namespace beatrix {

namespace {

// Consistent Overhead Byte Stuffing (Cheshire and Baker 1999) of less than 254 bytes.
class Stuffer {
 public:
  explicit Stuffer(uint8_t *out) : out_(out) {}

  void put(uint8_t byte) {
    if (byte) {
      out_[end_++] = byte;
      return;
    }
    close();
    code_ = end_++;
  }

  uint8_t finish() {
    close();
    return end_;
  }

 private:
  void close() { out_[code_] = uint8_t(end_ - code_); }

  uint8_t *out_;
  uint8_t code_ = 0;
  uint8_t end_ = 1;
};

}  // namespace

uint8_t encode(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size, uint8_t *out) {
  out[0] = 0;
  Stuffer stuffer(out + 1);
  uint16_t crc = crc_add(crc_add(CRC_START, type), seq);
  stuffer.put(type);
  stuffer.put(seq);
  for (uint8_t i = 0; i < size; i++) {
    crc = crc_add(crc, payload[i]);
    stuffer.put(payload[i]);
  }
  stuffer.put(uint8_t(crc));
  stuffer.put(uint8_t(crc >> 8));
  uint8_t length = stuffer.finish();
  out[length + 1] = 0;
  return uint8_t(length + 2);
}

static bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

Got Receiver::take(uint8_t byte) {
  if (byte == 0) return end();
  switch (mode_) {
    case TEXT: return take_text(byte);
    case BETWEEN:
      if (byte == TEXT_START) begin_text();
      break;
    case START: begin(byte); break;
    case BLANK:
      if (byte == TEXT_START) {
        begin_text();
        break;
      }
      if (!ends_line(byte)) mode_ = BLOCK;
      unstuff(byte);
      break;
    case BLOCK: unstuff(byte); break;
    case BROKEN:
      // No frame is that long: the delimiter was noise before text.
      if (ends_line(byte)) give_up();
      break;
  }
  return GOT_NOTHING;
}

void Receiver::give_up() {
  if (in_frame() || mode_ == BROKEN) rejected_++;
  mode_ = BETWEEN;
}

void Receiver::begin(uint8_t byte) {
  if (byte == TEXT_START) return begin_text();
  length_ = 0;
  crc_ = CRC_START;
  run_ = uint8_t(byte - 1);
  mode_ = ends_line(byte) ? BLANK : BLOCK;
}

void Receiver::unstuff(uint8_t byte) {
  if (run_) {
    run_--;
    put(byte);
  } else {
    run_ = uint8_t(byte - 1);
    put(0);
  }
}

void Receiver::put(uint8_t byte) {
  if (length_ == MAX_BODY) {
    mode_ = BROKEN;
  } else {
    body_[length_++] = byte;
    crc_ = crc_add(crc_, byte);
  }
}

// A line of text that has no end is no line: what follows is somebody else's.
Got Receiver::end() {
  Mode ended = mode_;
  mode_ = START;
  if (ended == BLOCK && run_ == 0 && correct()) return GOT_FRAME;
  if (ended == BLANK || ended == BLOCK || ended == BROKEN) rejected_++;
  return GOT_NOTHING;
}

// Over itself as well, a checksum of this kind is 0. Added up as the bytes come: the answer need not wait for it.
bool Receiver::correct() const { return length_ >= 4 && crc_ == 0; }

void Receiver::begin_text() {
  body_[0] = TEXT_START;
  length_ = 1;
  mode_ = TEXT;
}

Got Receiver::take_text(uint8_t byte) {
  if (ends_line(byte)) {
    mode_ = BETWEEN;
    return GOT_LINE;
  }
  if (length_ < TEXT_LINE_MAX) body_[length_] = byte;
  if (length_ <= TEXT_LINE_MAX) length_++;
  return GOT_NOTHING;
}

}  // namespace beatrix
