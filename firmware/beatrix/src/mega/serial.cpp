// Serial line to the host.
#include "../speed.h"
#include "serial.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../core/hal.h"

namespace beatrix {
namespace mega {

namespace {

const uint8_t CAPACITY = 255;  // one place stays empty, to distinguish a full ring from an empty one

TransmitBuffer transmit_buffer;

}  // namespace

ReceiveBuffer receive_buffer;

void start_serial(uint32_t baud) {
  UCSR0A = _BV(U2X0);
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UBRR0 = uint16_t((F_CPU / 8 + baud / 2) / baud - 1);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

}  // namespace mega

namespace hal {

uint16_t transmit_room() { return uint8_t(mega::CAPACITY - uint8_t(mega::transmit_buffer.head - mega::transmit_buffer.tail)); }

void send(const uint8_t *bytes, uint8_t count) {
  uint8_t head = mega::transmit_buffer.head;
  for (uint8_t i = 0; i < count; i++) mega::transmit_buffer.bytes[head++] = bytes[i];
  mega::transmit_buffer.head = head;
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0) | _BV(UDRIE0);
}

uint8_t bytes_lost() { return mega::receive_buffer.bytes_lost(); }

}  // namespace hal
}  // namespace beatrix

// About 80 cycles; at most 100. The main loop scans for stop frames (receive_buffer.h).
ISR(USART0_RX_vect) { beatrix::mega::receive_buffer.put(UDR0); }

// About 75 cycles; at most 100. The ring is empty if a tick interrupted send() before its last line for long enough.
ISR(USART0_UDRE_vect) {
  using beatrix::mega::transmit_buffer;
  uint8_t tail = transmit_buffer.tail;
  if (tail == transmit_buffer.head) {
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    return;
  }
  UDR0 = transmit_buffer.bytes[tail];
  transmit_buffer.tail = uint8_t(tail + 1);
}
