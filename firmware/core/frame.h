// Frames of the serial link: 0x00, COBS(type, seq, payload, CRC-16), 0x00.
#ifndef BEATRIX_FRAME_H
#define BEATRIX_FRAME_H

#include "contract.h"

namespace beatrix {

static const uint8_t MAX_BODY = uint8_t(MAX_PAYLOAD + 4);       // type, seq, payload, CRC
static const uint8_t MAX_WIRE = uint8_t(MAX_ENCODED + 2);       // with both delimiters
static const uint8_t WIRE_OVERHEAD = uint8_t(2 + 2 + 1 + 2);    // type and seq, CRC, COBS, delimiters

// Writes a frame to `out` (MAX_WIRE bytes); returns its length. size <= MAX_PAYLOAD.
uint8_t encode(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size, uint8_t *out);

// Takes frames apart, byte by byte. Everything that is no whole and correct frame is thrown away and counted;
// lines of text (first byte '@' where a frame could begin) are passed over and not counted.
class Receiver {
 public:
  // True: a frame is complete; type() to size() describe it until the next byte.
  bool take(uint8_t byte);

  uint8_t type() const { return body_[0]; }
  uint8_t seq() const { return body_[1]; }
  const uint8_t *payload() const { return body_ + 2; }
  uint8_t size() const { return uint8_t(length_ - 4); }
  uint16_t rejected() const { return rejected_; }

 private:
  enum Mode : uint8_t { START, BLOCK, BROKEN, TEXT, AFTER_TEXT };

  void begin(uint8_t byte);
  void unstuff(uint8_t byte);
  void put(uint8_t byte);
  bool end();
  bool correct() const;
  void take_text(uint8_t byte);

  uint8_t body_[MAX_BODY] = {};
  uint8_t length_ = 0;
  uint8_t run_ = 0;  // bytes until the next COBS code
  Mode mode_ = START;
  uint16_t rejected_ = 0;
};

}  // namespace beatrix

#endif
