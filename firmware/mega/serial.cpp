// The wire to the host.
#include "serial.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../core/hal.h"

namespace beatrix {
namespace mega {

namespace {

const uint8_t LAST = 255;  // one place stays empty: a full ring must not look like an empty one

Ring sent;

}  // namespace

Ring received;

void start_serial(uint32_t baud) {
  UCSR0A = _BV(U2X0);
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UBRR0 = uint16_t((F_CPU / 8 + baud / 2) / baud - 1);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

}  // namespace mega

namespace hal {

uint16_t room() { return uint8_t(mega::LAST - uint8_t(mega::sent.head - mega::sent.tail)); }

void send(const uint8_t *bytes, uint8_t count) {
  uint8_t head = mega::sent.head;
  for (uint8_t i = 0; i < count; i++) mega::sent.bytes[head++] = bytes[i];
  mega::sent.head = head;
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0) | _BV(UDRIE0);
}

}  // namespace hal
}  // namespace beatrix

// About 80 cycles. A byte for which there is no room is lost, and with it its frame: the checksum tells.
ISR(USART0_RX_vect) {
  using beatrix::mega::received;
  uint8_t byte = UDR0;
  uint8_t head = received.head;
  uint8_t next = uint8_t(head + 1);
  if (next == received.tail) return;
  received.bytes[head] = byte;
  received.head = next;
}

// About 75 cycles. Looks first: while a tick interrupts send() before its last line, all that it has queued may be sent.
ISR(USART0_UDRE_vect) {
  using beatrix::mega::sent;
  uint8_t tail = sent.tail;
  if (tail == sent.head) {
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    return;
  }
  UDR0 = sent.bytes[tail];
  sent.tail = uint8_t(tail + 1);
}
