// Frames of the serial link: 0x00, COBS(type, seq, payload, CRC-16), 0x00; and lines of text between them.
#ifndef BEATRIX_FRAME_H
#define BEATRIX_FRAME_H

#include "contract.h"

namespace beatrix {

static const uint8_t MAX_BODY = uint8_t(MAX_PAYLOAD + 4);       // type, seq, payload, CRC
static const uint8_t MAX_WIRE = uint8_t(MAX_ENCODED + 2);       // with both delimiters
static const uint8_t WIRE_OVERHEAD = uint8_t(2 + 2 + 1 + 2);    // type and seq, CRC, COBS, delimiters

// Writes a frame to `out` (MAX_WIRE bytes); returns its length. size <= MAX_PAYLOAD.
uint8_t encode(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size, uint8_t *out);

enum Got : uint8_t { GOT_NOTHING, GOT_FRAME, GOT_LINE };

// Takes frames and lines of text apart, byte by byte. Everything between delimiters that is no whole and correct frame
// is thrown away and counted. A line of text begins with '@' where a frame could begin and ends with CR, LF or both.
class Receiver {
 public:
  // GOT_FRAME: type() to size(), GOT_LINE: line() and line_size() describe it until the next byte.
  Got take(uint8_t byte);
  // Nothing came for so long that what has begun will not end.
  void give_up();
  // A frame has begun and may still become one.
  bool in_frame() const { return mode_ == BLANK || mode_ == BLOCK; }

  uint8_t type() const { return body_[0]; }
  uint8_t seq() const { return body_[1]; }
  const uint8_t *payload() const { return body_ + 2; }
  uint8_t size() const { return uint8_t(length_ - 4); }
  uint16_t rejected() const { return rejected_; }

  // Of a line that is too long only the begin is kept, and its size is more than TEXT_LINE_MAX.
  const uint8_t *line() const { return body_; }
  uint8_t line_size() const { return length_; }

 private:
  // BETWEEN lines of text, and before the first delimiter, a frame has to begin with one.
  enum Mode : uint8_t { BETWEEN, START, BLANK, BLOCK, BROKEN, TEXT };

  void begin(uint8_t byte);
  void begin_text();
  void unstuff(uint8_t byte);
  void put(uint8_t byte);
  Got end();
  bool correct() const;
  Got take_text(uint8_t byte);

  uint8_t length_ = 0;
  uint8_t run_ = 0;  // bytes until the next COBS code
  uint16_t crc_ = 0;
  Mode mode_ = BETWEEN;
  uint16_t rejected_ = 0;
  uint8_t body_[TEXT_LINE_MAX] = {};  // last: an AVR reaches 64 bytes from one address
};

}  // namespace beatrix

#endif
