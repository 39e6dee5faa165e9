// EEPROM: the number of starts, and the robot name.
//
// A cell lasts 100 000 writes, so the starts rotate through 64 records and names through two. A record ends with a
// checksum: if a reset interrupts a write, the previous record remains valid. Cell 0 is not used, because a failing
// supply is known to corrupt it.
#include "../speed.h"
#include "eeprom.h"

#include <avr/eeprom.h>

#include "../core/crc.h"
#include "../core/hal.h"

namespace beatrix {
namespace mega {

namespace {

struct BootRecord {
  uint32_t number;
  uint16_t crc;
};

struct Name {
  char name[NAME_SIZE];
  uint8_t version;  // one more than that of the older name; the newer name is loaded
  uint16_t crc;
};

const uint8_t BOOT_RECORDS = 64, NAMES = 2;
const uint16_t BOOT_RECORDS_AT = 8;
const uint16_t NAMES_AT = uint16_t(BOOT_RECORDS_AT + BOOT_RECORDS * sizeof(BootRecord));

uint32_t boots = 0;
Name name_record;            // the newest name, or the one being written
uint8_t name_slot = 0;      // of `name_record`
uint8_t bytes_written = sizeof(Name);

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

void count_boot() {
  uint8_t index = BOOT_RECORDS - 1;
  for (uint8_t i = 0; i < BOOT_RECORDS; i++) {
    BootRecord start;
    if (load(BOOT_RECORDS_AT, i, &start) && start.number >= boots) {
      boots = start.number;
      index = i;
    }
  }
  BootRecord start;
  start.number = ++boots;
  start.crc = crc_of(start);
  eeprom_update_block(&start, address<BootRecord>(BOOT_RECORDS_AT, uint8_t((index + 1) % BOOT_RECORDS)), sizeof(BootRecord));
  eeprom_busy_wait();
}

void continue_eeprom_write() {
  if (bytes_written == sizeof(Name) || !eeprom_is_ready()) return;
  const uint8_t *bytes = reinterpret_cast<uint8_t *>(&name_record);
  eeprom_update_byte(address<Name>(NAMES_AT, name_slot) + bytes_written, bytes[bytes_written]);
  bytes_written++;
}

}  // namespace mega

namespace hal {

uint32_t boot_number() { return mega::boots; }

void load_name(char name[NAME_SIZE]) {
  mega::Name candidate;
  bool found = false;
  for (uint8_t i = 0; i < mega::NAMES; i++) {
    if (mega::load(mega::NAMES_AT, i, &candidate) && (!found || int8_t(candidate.version - mega::name_record.version) > 0)) {
      mega::name_record = candidate;
      mega::name_slot = i;
      found = true;
    }
  }
  if (!found) mega::name_record = mega::Name();
  for (uint8_t i = 0; i < NAME_SIZE; i++) name[i] = mega::name_record.name[i];
}

// A new name replaces one that is still being written; the other slot keeps the last complete name.
void store_name(const char name[NAME_SIZE]) {
  bool same = true;
  for (uint8_t i = 0; i < NAME_SIZE; i++) same = same && name[i] == mega::name_record.name[i];
  if (same) return;
  if (mega::bytes_written == sizeof(mega::Name)) {
    mega::name_slot = uint8_t((mega::name_slot + 1) % mega::NAMES);
    mega::name_record.version++;
  }
  for (uint8_t i = 0; i < NAME_SIZE; i++) mega::name_record.name[i] = name[i];
  mega::name_record.crc = mega::crc_of(mega::name_record);
  mega::bytes_written = 0;
}

}  // namespace hal
}  // namespace beatrix
