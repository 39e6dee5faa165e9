// Frames of the serial link, 0x00, COBS(type, seq, payload, CRC-16), 0x00, and lines of text between them.
#ifndef BEATRIX_FRAME_H
#define BEATRIX_FRAME_H

#include "contract.h"

namespace beatrix {

static const uint8_t MAX_BODY = uint8_t(MAX_PAYLOAD + 4);       // type, seq, payload, CRC
static const uint8_t MAX_WIRE = uint8_t(MAX_ENCODED + 2);       // with both delimiters
static const uint8_t WIRE_OVERHEAD = uint8_t(2 + 2 + 1 + 2);    // type and seq, CRC, COBS, delimiters

// Write a frame to `out` (MAX_WIRE bytes), and return its length. `size` is at most MAX_PAYLOAD.
uint8_t encode(uint8_t type, uint8_t seq, const uint8_t *payload, uint8_t size, uint8_t *out);

// Bytes of the COBS block of STOP and EMERGENCY_STOP, which have no payload: COBS code, type, seq and CRC.
static const uint8_t STOP_BLOCK = 5;
// Decode a block of this length; return false if it is not a stop frame or has a wrong CRC.
bool read_stop(const uint8_t block[STOP_BLOCK], uint8_t *type, uint8_t *seq);

enum Received : uint8_t { RECEIVED_NOTHING, RECEIVED_FRAME, RECEIVED_LINE };

// Decodes frames and lines of text, byte by byte. Anything else between two delimiters is discarded and counted. A line
// of text begins with '@' where a frame could begin and ends with CR, LF or both.
class Receiver {
 public:
  // After RECEIVED_FRAME, type() to size() are valid until the next byte; after RECEIVED_LINE, line() and line_size().
  Received feed(uint8_t byte);
  // Discard an incomplete frame or line after a timeout.
  void abandon();
  // Return whether the bytes received so far may be the start of a frame.
  bool in_frame() const { return mode_ == LINE_END_FIRST || mode_ == FRAME; }

  uint8_t type() const { return body_[0]; }
  uint8_t seq() const { return body_[1]; }
  const uint8_t *payload() const { return body_ + 2; }
  uint8_t size() const { return uint8_t(length_ - 4); }
  uint16_t rejected() const { return rejected_; }

  // Of a line that is too long, line() has the first TEXT_LINE_MAX bytes, and line_size() is TEXT_LINE_MAX + 1.
  const uint8_t *line() const { return body_; }
  uint8_t line_size() const { return length_; }

 private:
  // OUTSIDE: before the first delimiter and after a line of text; a frame must begin with a delimiter.
  // LINE_END_FIRST: after the delimiter only CR or LF came, which may begin a frame, or be empty lines before text.
  enum Mode : uint8_t { OUTSIDE, START, LINE_END_FIRST, FRAME, TOO_LONG, TEXT };

  void begin_frame(uint8_t byte);
  void begin_text();
  void decode(uint8_t byte);
  void put(uint8_t byte);
  Received end();
  bool correct() const;
  Received take_text(uint8_t byte);

  uint8_t length_ = 0;
  uint8_t run_ = 0;  // bytes until the next COBS code
  uint16_t crc_ = 0;
  Mode mode_ = OUTSIDE;
  uint16_t rejected_ = 0;
  uint8_t body_[TEXT_LINE_MAX] = {};  // last: an AVR addresses 64 bytes from one pointer
};

}  // namespace beatrix

#endif
