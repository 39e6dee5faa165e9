// The CNC shield on an Arduino Mega 2560: which port bit is which wire of which arm.
#ifndef BEATRIX_MEGA_PINS_H
#define BEATRIX_MEGA_PINS_H

#include <avr/io.h>

namespace beatrix {
namespace mega {

// An arm's wires and the compare channel that times its steps. Bits of port H are not reached by single instructions:
// change them with interrupts off.
template <uint8_t ARM>
struct Wires;

template <>
struct Wires<0> {  // X: step D2, direction D5
  static void rise() { PORTE = uint8_t(PORTE | _BV(4)); }
  static void fall() { PORTE = uint8_t(PORTE & ~_BV(4)); }
  static void forward() { PORTE = uint8_t(PORTE | _BV(3)); }
  static void backward() { PORTE = uint8_t(PORTE & ~_BV(3)); }
  static volatile uint16_t &match() { return OCR1A; }
  static const uint8_t FLAG = _BV(OCF1A);
};

template <>
struct Wires<1> {  // Y: step D3, direction D6
  static void rise() { PORTE = uint8_t(PORTE | _BV(5)); }
  static void fall() { PORTE = uint8_t(PORTE & ~_BV(5)); }
  static void forward() { PORTH = uint8_t(PORTH | _BV(3)); }
  static void backward() { PORTH = uint8_t(PORTH & ~_BV(3)); }
  static volatile uint16_t &match() { return OCR1B; }
  static const uint8_t FLAG = _BV(OCF1B);
};

template <>
struct Wires<2> {  // Z: step D4, direction D7
  static void rise() { PORTG = uint8_t(PORTG | _BV(5)); }
  static void fall() { PORTG = uint8_t(PORTG & ~_BV(5)); }
  static void forward() { PORTH = uint8_t(PORTH | _BV(4)); }
  static void backward() { PORTH = uint8_t(PORTH & ~_BV(4)); }
  static volatile uint16_t &match() { return OCR1C; }
  static const uint8_t FLAG = _BV(OCF1C);
};

// Drivers: D8, on while low.
inline void enable_wire_on() { PORTH = uint8_t(PORTH & ~_BV(5)); }
inline void enable_wire_off() { PORTH = uint8_t(PORTH | _BV(5)); }

// Drivers are off from the first moment on: high before output.
inline void make_outputs() {
  enable_wire_off();
  DDRH = uint8_t(DDRH | _BV(3) | _BV(4) | _BV(5));
  DDRE = uint8_t(DDRE | _BV(3) | _BV(4) | _BV(5));
  DDRG = uint8_t(DDRG | _BV(5));
}

}  // namespace mega
}  // namespace beatrix

#endif
