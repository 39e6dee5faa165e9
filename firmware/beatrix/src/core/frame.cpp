// Frames of the serial link.
#include "../speed.h"
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

bool read_stop(const uint8_t block[STOP_BLOCK], uint8_t *type, uint8_t *seq) {
  uint8_t body[STOP_BLOCK - 1];
  uint8_t run = uint8_t(block[0] - 1);
  uint16_t crc = CRC_START;
  for (uint8_t i = 0; i < STOP_BLOCK - 1; i++) {
    uint8_t byte = block[i + 1];
    if (run) {
      run--;
    } else {
      run = uint8_t(byte - 1);
      byte = 0;
    }
    body[i] = byte;
    crc = crc_add(crc, byte);
  }
  *type = body[0];
  *seq = body[1];
  return run == 0 && crc == 0 && (*type == FRAME_STOP || *type == FRAME_EMERGENCY_STOP);
}

static bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

Received Receiver::feed(uint8_t byte) {
  if (byte == 0) return end();
  switch (mode_) {
    case TEXT: return take_text(byte);
    case OUTSIDE:
      if (byte == TEXT_START) begin_text();
      break;
    case START: begin_frame(byte); break;
    case LINE_END_FIRST:
      if (byte == TEXT_START) {
        begin_text();
        break;
      }
      if (!ends_line(byte)) mode_ = FRAME;
      decode(byte);
      break;
    case FRAME: decode(byte); break;
    case TOO_LONG:
      // No frame is this long: the delimiter was noise before a line of text, which ends here.
      if (ends_line(byte)) abandon();
      break;
  }
  return RECEIVED_NOTHING;
}

void Receiver::abandon() {
  if (in_frame() || mode_ == TOO_LONG) rejected_++;
  mode_ = OUTSIDE;
}

void Receiver::begin_frame(uint8_t byte) {
  if (byte == TEXT_START) return begin_text();
  length_ = 0;
  crc_ = CRC_START;
  run_ = uint8_t(byte - 1);
  mode_ = ends_line(byte) ? LINE_END_FIRST : FRAME;
}

void Receiver::decode(uint8_t byte) {
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
    mode_ = TOO_LONG;
  } else {
    body_[length_++] = byte;
    crc_ = crc_add(crc_, byte);
  }
}

// A delimiter also ends an incomplete line of text: the line is discarded.
Received Receiver::end() {
  Mode ended = mode_;
  mode_ = START;
  if (ended == FRAME && run_ == 0 && correct()) return RECEIVED_FRAME;
  if (ended == LINE_END_FIRST || ended == FRAME || ended == TOO_LONG) rejected_++;
  return RECEIVED_NOTHING;
}

// The CRC over a correct frame, including its CRC, is 0. It is computed as the bytes arrive, so it delays no reply.
bool Receiver::correct() const { return length_ >= 4 && crc_ == 0; }

void Receiver::begin_text() {
  body_[0] = TEXT_START;
  length_ = 1;
  mode_ = TEXT;
}

Received Receiver::take_text(uint8_t byte) {
  if (ends_line(byte)) {
    mode_ = OUTSIDE;
    return RECEIVED_LINE;
  }
  if (length_ < TEXT_LINE_MAX) body_[length_] = byte;
  if (length_ <= TEXT_LINE_MAX) length_++;
  return RECEIVED_NOTHING;
}

}  // namespace beatrix
