// What the board remembers without power.
//
// A cell bears 100 000 writes. Starts are counted in 64 records written in turn; names in two. A record ends with a
// checksum: one that a reset has cut short is not valid, and the one before still is. Cell 0 is left alone, since it
// is the one that a failing supply is known to hit.
#include "memory.h"

#include <avr/eeprom.h>

#include "../core/crc.h"
#include "../core/hal.h"

namespace beatrix {
namespace mega {

namespace {

struct Start {
  uint32_t number;
  uint16_t crc;
};

struct Name {
  char name[NAME_SIZE];
  uint8_t turn;  // counts names, to tell the newer of two
  uint16_t crc;
};

const uint8_t STARTS = 64, NAMES = 2;
const uint16_t STARTS_AT = 8;
const uint16_t NAMES_AT = uint16_t(STARTS_AT + STARTS * sizeof(Start));

uint32_t starts = 0;
Name stored;            // the newest name, or the one being stored
uint8_t place = 0;      // of `stored`
uint8_t written = sizeof(Name);

template <typename Record>
uint16_t crc_of(const Record &record) {
  const uint8_t *bytes = reinterpret_cast<const uint8_t *>(&record);
  uint16_t crc = CRC_START;
  for (uint8_t i = 0; i < sizeof(Record) - sizeof(record.crc); i++) crc = crc_add(crc, bytes[i]);
  return crc;
}

template <typename Record>
uint8_t *address(uint16_t first, uint8_t index) {
  return reinterpret_cast<uint8_t *>(first + index * sizeof(Record));
}

template <typename Record>
bool load(uint16_t first, uint8_t index, Record *record) {
  eeprom_read_block(record, address<Record>(first, index), sizeof(Record));
  return record->crc == crc_of(*record);
}

}  // namespace

void count_start() {
  uint8_t index = STARTS - 1;
  for (uint8_t i = 0; i < STARTS; i++) {
    Start start;
    if (load(STARTS_AT, i, &start) && start.number >= starts) {
      starts = start.number;
      index = i;
    }
  }
  Start start;
  start.number = ++starts;
  start.crc = crc_of(start);
  eeprom_update_block(&start, address<Start>(STARTS_AT, uint8_t((index + 1) % STARTS)), sizeof(Start));
  eeprom_busy_wait();
}

void work_on_memory() {
  if (written == sizeof(Name) || !eeprom_is_ready()) return;
  eeprom_update_byte(address<Name>(NAMES_AT, place) + written, reinterpret_cast<uint8_t *>(&stored)[written]);
  written++;
}

}  // namespace mega

namespace hal {

uint32_t boot_number() { return mega::starts; }

void load_name(char name[NAME_SIZE]) {
  mega::Name candidate;
  bool found = false;
  for (uint8_t i = 0; i < mega::NAMES; i++) {
    if (mega::load(mega::NAMES_AT, i, &candidate) && (!found || int8_t(candidate.turn - mega::stored.turn) > 0)) {
      mega::stored = candidate;
      mega::place = i;
      found = true;
    }
  }
  if (!found) mega::stored = mega::Name();
  for (uint8_t i = 0; i < NAME_SIZE; i++) name[i] = mega::stored.name[i];
}

// While one name is being stored, its place is taken by the next: the other place holds the last whole one.
void store_name(const char name[NAME_SIZE]) {
  bool same = true;
  for (uint8_t i = 0; i < NAME_SIZE; i++) same = same && name[i] == mega::stored.name[i];
  if (same) return;
  if (mega::written == sizeof(mega::Name)) {
    mega::place = uint8_t((mega::place + 1) % mega::NAMES);
    mega::stored.turn++;
  }
  for (uint8_t i = 0; i < NAME_SIZE; i++) mega::stored.name[i] = name[i];
  mega::stored.crc = mega::crc_of(mega::stored);
  mega::written = 0;
}

}  // namespace hal
}  // namespace beatrix
