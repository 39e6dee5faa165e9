// EEPROM: the number of starts, and the robot name.
#ifndef BEATRIX_MEGA_EEPROM_H
#define BEATRIX_MEGA_EEPROM_H

namespace beatrix {
namespace mega {

// Count this start, and return when its number is stored, so that no boot number is used twice.
void count_boot();
// Write the next byte of a new name, if the EEPROM is not busy. Called by the main loop.
void continue_eeprom_write();

}  // namespace mega
}  // namespace beatrix

#endif
