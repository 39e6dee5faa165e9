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

bool Receiver::take(uint8_t byte) {
  if (byte == 0) return end();
  switch (mode_) {
    case START: begin(byte); break;
    case BLOCK: unstuff(byte); break;
    case BROKEN: break;
    case TEXT:
    case AFTER_TEXT: take_text(byte); break;
  }
  return false;
}

void Receiver::begin(uint8_t byte) {
  length_ = 0;
  run_ = uint8_t(byte - 1);
  mode_ = byte == TEXT_START ? TEXT : BLOCK;
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
  }
}

bool Receiver::end() {
  Mode ended = mode_;
  mode_ = START;
  if (ended == BLOCK && run_ == 0 && correct()) return true;
  if (ended == BLOCK || ended == BROKEN) rejected_++;
  return false;
}

bool Receiver::correct() const {
  if (length_ < 4) return false;
  uint16_t crc = CRC_START;
  for (uint8_t i = 0; i < length_ - 2; i++) crc = crc_add(crc, body_[i]);
  return crc == get_u16(body_ + length_ - 2);
}

// The old text protocol has its place here. A line ends with CR or LF; after it only another line or a delimiter
// counts, so that CR LF is one end and no byte of text is taken for the begin of a frame.
void Receiver::take_text(uint8_t byte) {
  if (byte == '\r' || byte == '\n') {
    mode_ = AFTER_TEXT;
  } else if (mode_ == AFTER_TEXT && byte == TEXT_START) {
    mode_ = TEXT;
  }
}

}  // namespace beatrix
