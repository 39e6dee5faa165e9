// CNC shield on an Arduino Mega 2560: the port bits of each arm.
#ifndef BEATRIX_MEGA_PINS_H
#define BEATRIX_MEGA_PINS_H

#include <avr/io.h>

namespace beatrix {
namespace mega {

// Pins of an arm, and the compare channel for its steps. Port H has no single-bit instructions: change its bits with
// interrupts disabled.
template <uint8_t ARM>
struct ArmPins;

template <>
struct ArmPins<0> {  // X: step D2, direction D5
  static void step_high() { PORTE = uint8_t(PORTE | _BV(4)); }
  static void step_low() { PORTE = uint8_t(PORTE & ~_BV(4)); }
  static void forward() { PORTE = uint8_t(PORTE | _BV(3)); }
  static void backward() { PORTE = uint8_t(PORTE & ~_BV(3)); }
  static volatile uint16_t &match() { return OCR1A; }
  static const uint8_t FLAG = _BV(OCF1A);
};

template <>
struct ArmPins<1> {  // Y: step D3, direction D6
  static void step_high() { PORTE = uint8_t(PORTE | _BV(5)); }
  static void step_low() { PORTE = uint8_t(PORTE & ~_BV(5)); }
  static void forward() { PORTH = uint8_t(PORTH | _BV(3)); }
  static void backward() { PORTH = uint8_t(PORTH & ~_BV(3)); }
  static volatile uint16_t &match() { return OCR1B; }
  static const uint8_t FLAG = _BV(OCF1B);
};

template <>
struct ArmPins<2> {  // Z: step D4, direction D7
  static void step_high() { PORTG = uint8_t(PORTG | _BV(5)); }
  static void step_low() { PORTG = uint8_t(PORTG & ~_BV(5)); }
  static void forward() { PORTH = uint8_t(PORTH | _BV(4)); }
  static void backward() { PORTH = uint8_t(PORTH & ~_BV(4)); }
  static volatile uint16_t &match() { return OCR1C; }
  static const uint8_t FLAG = _BV(OCF1C);
};

// Driver enable: D8, active low.
inline void set_enable_pin_on() { PORTH = uint8_t(PORTH & ~_BV(5)); }
inline void set_enable_pin_off() { PORTH = uint8_t(PORTH | _BV(5)); }

// Make the pins outputs. The enable pin is set high before, so that the drivers never switch on at start.
inline void make_outputs() {
  set_enable_pin_off();
  DDRH = uint8_t(DDRH | _BV(3) | _BV(4) | _BV(5));
  DDRE = uint8_t(DDRE | _BV(3) | _BV(4) | _BV(5));
  DDRG = uint8_t(DDRG | _BV(5));
}

}  // namespace mega
}  // namespace beatrix

#endif
