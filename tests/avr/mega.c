// A simulated Arduino Mega 2560: libsimavr 1.6 with corrections, serial wires with exact timing, and a log of the pins'
// levels. Python (bench.py) calls it through ctypes, from one thread at a time.
//
// libsimavr 1.6 differs from the chip in these points; this file corrects them:
//   libsimavr                                                                        here
//   INT4 and INT5 (the step pins of X and Y) in level mode poll every cycle          strict level triggering is off
//   an interrupt's response time (5 cycles, 5 more from sleep) is not counted        counted when its vector is called
//   a compare match some cycles after a timer's overflow is lost                     found and raised (on_overflow)
//   a flag raised while its interrupt is masked is lost on unmasking                 raised again (unmask)
//   a byte takes 11 bit times, the receive buffer has 64 places                      10 bit times, 2 places
//   an EEPROM write ends at once, and a reset does not damage it                     3.4 ms; a reset damages its byte
//   flash can be written again without being erased                                  bits only change from 1 to 0
//   the pins keep their level in reset                                               the drivers' pull-up is modelled
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <simavr/avr_adc.h>
#include <simavr/avr_eeprom.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_flash.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_hex.h>

enum { ARMS = 3, VECTORS = 64, ADC_INPUTS = 16 };
enum { STEP = 0, DIRECTION = 3, ENABLE = 6, SIGNALS = 7 };
enum { RESPONSE = 5, WAKE = 5, EEPROM_WRITE = 54400, UART_BUFFER = 2, RUN_LIMIT = 1000 };
enum { UCSR0A = 0xC0, UCSR0B = 0xC1, UDR0 = 0xC6, RXC0 = 0x80, RXEN0 = 0x10 };
enum { PINE = 0x2C, PORTH = 0x102, DDRH = 0x101, ENABLE_BIT = 0x20 };
enum { EECR = 0x3F, EEPE = 0x02, EEMPE = 0x04, EEDR = 0x40, EEARL = 0x41, EEARH = 0x42 };
enum { TCCR1B = 0x81, TCCR3B = 0x91, TIMER1_OVERFLOW = 20, TIMER3_OVERFLOW = 35, RXC_VECTOR = 25 };
enum { FIRST_MASK = 0x6E, LAST_MASK = 0x73 };  // TIMSK0 to TIMSK5

typedef struct {
  uint64_t cycle;
  uint8_t signal;
  uint8_t level;
} Edge;

typedef struct {
  uint64_t cycle;  // when its stop bit ended
  uint8_t byte;
} Byte;

typedef struct {
  uint64_t calls, cycles, longest;  // without nested interrupts; with response and return
  uint64_t last;                    // cycle of the last call
} Work;

// The data that Python reads; all counts are since power-on.
typedef struct {
  uint64_t cycle, slept;
  uint64_t edges, sent;  // lengths of the logs
  uint64_t overruns, resets, unread;
  Work work[VECTORS];
  uint8_t levels[SIGNALS];
} Report;

typedef struct Bench Bench;
struct Bench {
  avr_t *avr;
  avr_uart_t *uart;
  avr_timer_t *timer1, *timer3;
  avr_io_t watch;  // callbacks for resets and for writing of flash
  Report report;
  Edge *edges;
  size_t edge_room;
  Byte *sent;
  size_t sent_room, taken;
  uint64_t wire_free;  // cycle at which the last byte of the board ends

  uint8_t *queue;  // bytes on their way to the board
  size_t queue_room, queue_head, queue_tail;
  uint64_t byte_cycles;
  uint8_t buffer[UART_BUFFER], buffered;
  bool shifted;  // a whole byte waits in the shift register for a place in the buffer
  uint8_t shift;

  avr_io_write_t eeprom_write;
  void *eeprom_param;
  uint32_t eeprom_address;
  bool eeprom_busy;

  struct { int vector; uint64_t since; uint64_t own; } running[VECTORS];
  int depth;
  bool woken, fresh;
  uint32_t millivolts[ADC_INPUTS];
};

// --- pins

static void log_edge(Bench *b, uint8_t signal, uint8_t level) {
  if (b->report.levels[signal] == level) return;
  b->report.levels[signal] = level;
  if (b->report.edges == b->edge_room) {
    b->edge_room = b->edge_room ? 2 * b->edge_room : 4096;
    b->edges = realloc(b->edges, b->edge_room * sizeof(Edge));
  }
  Edge edge = {b->avr->cycle, signal, level};
  b->edges[b->report.edges++] = edge;
}

typedef struct {
  Bench *bench;
  uint8_t signal;
} Wire;

static void on_pin(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  Wire *wire = param;
  log_edge(wire->bench, wire->signal, value & 1);
}

// The drivers are off while their wire is not driven, because the shield has a pull-up.
static void look_at_enable(Bench *b, uint8_t direction, uint8_t port) {
  log_edge(b, ENABLE, (direction & ENABLE_BIT) && !(port & ENABLE_BIT) ? 0 : 1);
}

static void on_enable_direction(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  Bench *b = param;
  look_at_enable(b, value, b->avr->data[PORTH]);
}

static void on_enable_port(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  Bench *b = param;
  look_at_enable(b, b->avr->data[DDRH], value);
}

static void connect_pins(Bench *b) {
  static const struct { char port; uint8_t bit; } pins[6] = {{'E', 4}, {'E', 5}, {'G', 5}, {'E', 3}, {'H', 3}, {'H', 4}};
  for (uint8_t i = 0; i < 6; i++) {
    Wire *wire = malloc(sizeof(Wire));
    wire->bench = b;
    wire->signal = i;
    avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ(pins[i].port), pins[i].bit), on_pin, wire);
  }
  b->report.levels[ENABLE] = 1;
  avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ('H'), IOPORT_IRQ_DIRECTION_ALL),
                          on_enable_direction, b);
  avr_irq_register_notify(avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ('H'), IOPORT_IRQ_REG_PORT), on_enable_port, b);
}

// --- interrupts

static void on_vector(avr_irq_t *irq, uint32_t running, void *param) {
  Bench *b = param;
  uint64_t at = b->avr->cycle;
  if (running) {
    b->avr->cycle += RESPONSE + (b->woken ? WAKE : 0);
    b->avr->run_cycle_count = 1;  // otherwise a compare match in these cycles is lost
    b->woken = false;
    if (b->depth == VECTORS) return;
    b->running[b->depth].vector = irq->irq / 256;
    b->running[b->depth].since = at;
    b->report.work[irq->irq / 256 % VECTORS].last = at;
    b->running[b->depth].own = 0;
    b->depth++;
  } else if (b->depth) {
    b->depth--;
    // The return instruction's own 5 cycles are counted after this call.
    uint64_t whole = at + 5 - b->running[b->depth].since;
    uint64_t own = whole - b->running[b->depth].own;
    Work *work = &b->report.work[b->running[b->depth].vector % VECTORS];
    work->calls++;
    work->cycles += own;
    if (own > work->longest) work->longest = own;
    if (b->depth) b->running[b->depth - 1].own += whole;
  }
}

static void unmask(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  (void)param;
  avr_core_watch_write(avr, address, value);
  for (int i = 0; i < avr->interrupts.vector_count; i++) {
    avr_int_vector_t *vector = avr->interrupts.vector[i];
    if (vector->enable.reg == address && avr_regbit_get(avr, vector->enable) && avr_regbit_get(avr, vector->raised)) {
      avr_raise_interrupt(avr, vector);
    }
  }
}

// libsimavr looks for compare matches when it handles an overflow, which may be some cycles late, and skips those that
// were due in between. Raise these here; otherwise a step or a tick would be 4 ms late.
static avr_cycle_count_t on_overflow(avr_t *avr, avr_cycle_count_t when, void *param) {
  avr_timer_t *timer = param;
  uint64_t begin = timer->tov_base, whole = timer->tov_cycles;
  if (begin != when && begin + whole != when) return begin + whole;  // the timer was restarted
  for (int i = 0; i < AVR_TIMER_COMP_COUNT; i++) {
    uint64_t match = timer->comp[i].comp_cycles;
    if (match && when + match < avr->cycle) avr_raise_interrupt(avr, &timer->comp[i].interrupt);
  }
  return when + whole;
}

// libsimavr calls its own handler before this one, so `timer` already has the new period.
static void on_clock(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  Bench *b = param;
  avr_timer_t *timer = address == TCCR1B ? b->timer1 : b->timer3;
  avr_cycle_timer_cancel(avr, on_overflow, timer);
  if (value & 7) avr_cycle_timer_register(avr, timer->tov_base + timer->tov_cycles - avr->cycle, on_overflow, timer);
}

static void on_sleep(avr_t *avr, avr_cycle_count_t cycles) {
  Bench *b = avr->custom.data;
  b->report.slept += cycles + 1;
  b->woken = true;
}

// --- UART 0, receiving

static void offer(Bench *b) {
  if (!b->buffered) return;
  avr_raise_interrupt(b->avr, &b->uart->rxc);
}

static void take_from_shift_register(Bench *b) {
  if (b->shifted && b->buffered < UART_BUFFER) {
    b->buffer[b->buffered++] = b->shift;
    b->shifted = false;
  }
}

// Handles the stop bit of a byte. If buffer and shift register are full, the byte overwrites the latter: an overrun.
static avr_cycle_count_t on_byte(avr_t *avr, avr_cycle_count_t when, void *param) {
  Bench *b = param;
  uint8_t byte = b->queue[b->queue_head++];
  b->report.unread = b->queue_tail - b->queue_head;
  if (avr->data[UCSR0B] & RXEN0) {
    if (b->shifted) b->report.overruns++;
    b->shift = byte;
    b->shifted = true;
    take_from_shift_register(b);
    offer(b);
  }
  return b->report.unread ? when + b->byte_cycles : 0;
}

static uint8_t on_read(avr_t *avr, avr_io_addr_t address, void *param) {
  Bench *b = param;
  uint8_t byte = b->buffer[0];
  if (b->buffered) {
    b->buffer[0] = b->buffer[1];
    b->buffered--;
    take_from_shift_register(b);
  }
  avr->data[address] = byte;
  avr_clear_interrupt(avr, &b->uart->rxc);
  avr->data[UCSR0A] &= ~RXC0;
  offer(b);
  return byte;
}

static void on_sent(avr_irq_t *irq, uint32_t value, void *param) {
  (void)irq;
  Bench *b = param;
  uint64_t start = b->wire_free > b->avr->cycle ? b->wire_free : b->avr->cycle;
  b->wire_free = start + b->uart->cycles_per_byte;
  if (b->report.sent == b->sent_room) {
    b->sent_room = b->sent_room ? 2 * b->sent_room : 4096;
    b->sent = realloc(b->sent, b->sent_room * sizeof(Byte));
  }
  Byte byte = {b->wire_free, value};
  b->sent[b->report.sent++] = byte;
}

// Sets the time of a byte to ten bits instead of eleven, after libsimavr's own handler.
static void on_baud(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  (void)address, (void)value;
  Bench *b = param;
  uint32_t divider = (avr->data[0xC4] | (avr->data[0xC5] & 0x0F) << 8) + 1;
  b->uart->cycles_per_byte = 10 * divider * (avr->data[UCSR0A] & 0x02 ? 8 : 16);
}

// --- EEPROM

static avr_cycle_count_t on_written(avr_t *avr, avr_cycle_count_t when, void *param) {
  (void)when;
  Bench *b = param;
  b->eeprom_busy = false;
  avr->data[EECR] &= ~EEPE;
  return 0;
}

static void on_eeprom(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
  Bench *b = param;
  bool writes = (value & EEPE) && (avr->data[EECR] & EEMPE) && !b->eeprom_busy;
  b->eeprom_write(avr, address, b->eeprom_busy ? value & ~EEPE : value, b->eeprom_param);
  if (writes) {
    b->eeprom_busy = true;
    b->eeprom_address = avr->data[EEARL] | avr->data[EEARH] << 8;
    avr_cycle_timer_register(avr, EEPROM_WRITE, on_written, b);
  }
  if (b->eeprom_busy) avr->data[EECR] |= EEPE;
}

static void use_eeprom(Bench *b, uint32_t action, uint8_t *bytes, uint32_t offset, uint32_t size) {
  avr_eeprom_desc_t part = {bytes, offset, size};
  avr_ioctl(b->avr, action, &part);
}

// --- flash

// Lets writes change bits from 1 to 0 only, as on the chip. libsimavr calls this for every SPM, before it writes.
static int on_store(avr_io_t *io, uint32_t control, void *param) {
  (void)param;
  avr_t *avr = io->avr;
  if (control != AVR_IOCTL_FLASH_SPM) return -1;
  while (strcmp(io->kind, "flash")) io = io->next;
  avr_flash_t *part = (avr_flash_t *)io;
  if (!avr_regbit_get(avr, part->pgwrt)) return -1;
  uint32_t z = (uint32_t)avr->data[avr->rampz] << 16 | avr->data[R_ZH] << 8 | avr->data[R_ZL];
  const uint8_t *held = avr->flash + (z & ~(part->spm_pagesize - 1u));
  for (int i = 0; i < part->spm_pagesize / 2; i++) part->tmppage[i] &= held[2 * i] | held[2 * i + 1] << 8;
  return -1;
}

// --- reset, start, run

// libsimavr calls this for a reset of any cause, before it resets its own parts.
static void on_reset(avr_io_t *io) {
  Bench *b = io->avr->custom.data;
  b->report.resets++;
  b->depth = 0;
  b->buffered = 0;
  b->shifted = b->woken = false;
  b->fresh = true;
  while (b->report.sent && b->sent[b->report.sent - 1].cycle > b->avr->cycle) b->report.sent--;  // incomplete bytes
  b->wire_free = 0;
  if (b->eeprom_busy) {
    uint8_t damaged = 0x55;
    use_eeprom(b, AVR_IOCTL_EEPROM_SET, &damaged, b->eeprom_address, 1);
    b->eeprom_busy = false;
  }
  look_at_enable(b, 0, 0);
}

// Restores settings that a reset of libsimavr clears, before the first instruction.
static void prepare(Bench *b) {
  b->fresh = false;
  b->avr->run_cycle_limit = RUN_LIMIT;
  for (int i = 0; i < 8; i++) avr_extint_set_strict_lvl_trig(b->avr, i, 0);
  if (b->queue_head < b->queue_tail) avr_cycle_timer_register(b->avr, b->byte_cycles, on_byte, b);
  for (int i = 0; i < ADC_INPUTS; i++) {
    avr_raise_irq(avr_io_getirq(b->avr, AVR_IOCTL_ADC_GETIRQ, i), b->millivolts[i]);
  }
}

static const uint32_t BOOT_LOADER = 0x3E000;

static bool load(avr_t *avr, const char *path) {
  const char *ending = strrchr(path, '.');
  if (ending && !strcmp(ending, ".hex")) {
    ihex_chunk_p chunks;
    int count = read_ihex_chunks(path, &chunks);
    for (int i = 0; i < count; i++) avr_loadcode(avr, chunks[i].data, chunks[i].size, chunks[i].baseaddr);
    if (count <= 0) return false;
    avr->codeend = chunks[count - 1].baseaddr + chunks[count - 1].size;
    // The fuses of the Mega start a boot loader, which is at the end of the flash, instead of address 0.
    if (chunks[count - 1].baseaddr >= BOOT_LOADER) avr->reset_pc = avr->pc = BOOT_LOADER;
    return true;
  }
  elf_firmware_t firmware;
  memset(&firmware, 0, sizeof firmware);
  if (elf_read_firmware(path, &firmware)) return false;
  firmware.frequency = avr->frequency;
  avr_load_firmware(avr, &firmware);
  return true;
}

static void attach(Bench *b) {
  avr_t *avr = b->avr;
  for (int i = 0; i < avr->interrupts.vector_count; i++) {
    avr_irq_register_notify(avr->interrupts.vector[i]->irq + AVR_INT_IRQ_RUNNING, on_vector, b);
    char *vector = (char *)avr->interrupts.vector[i];
    switch (avr->interrupts.vector[i]->vector) {
      case RXC_VECTOR: b->uart = (avr_uart_t *)(vector - offsetof(avr_uart_t, rxc)); break;
      case TIMER1_OVERFLOW: b->timer1 = (avr_timer_t *)(vector - offsetof(avr_timer_t, overflow)); break;
      case TIMER3_OVERFLOW: b->timer3 = (avr_timer_t *)(vector - offsetof(avr_timer_t, overflow)); break;
    }
  }
  for (int address = FIRST_MASK; address <= LAST_MASK; address++) avr_register_io_write(avr, address, unmask, NULL);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), on_sent, b);
  b->uart->flags &= ~(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
  avr_register_io_write(avr, 0xC4, on_baud, b);
  avr_register_io_write(avr, TCCR1B, on_clock, b);
  avr_register_io_write(avr, TCCR3B, on_clock, b);
  avr->io[AVR_DATA_TO_IO(UDR0)].r.c = on_read;
  avr->io[AVR_DATA_TO_IO(UDR0)].r.param = b;
  b->eeprom_write = avr->io[AVR_DATA_TO_IO(EECR)].w.c;
  b->eeprom_param = avr->io[AVR_DATA_TO_IO(EECR)].w.param;
  avr->io[AVR_DATA_TO_IO(EECR)].w.c = on_eeprom;
  avr->io[AVR_DATA_TO_IO(EECR)].w.param = b;
  connect_pins(b);
  b->watch.kind = "bench";
  b->watch.reset = on_reset;
  b->watch.ioctl = on_store;
  avr_register_io(avr, &b->watch);
}

Bench *bench_open(const char *path, const uint8_t *eeprom, uint32_t eeprom_size) {
  avr_t *avr = avr_make_mcu_by_name("atmega2560");
  if (!avr) return NULL;
  Bench *b = calloc(1, sizeof(Bench));
  b->avr = avr;
  avr->custom.data = b;
  avr_init(avr);
  avr->frequency = 16000000;
  avr->log = LOG_ERROR;
  avr->vcc = avr->avcc = avr->aref = 5000;
  avr->sleep = on_sleep;
  b->byte_cycles = 640;
  attach(b);
  if (!load(avr, path)) return NULL;
  use_eeprom(b, AVR_IOCTL_EEPROM_SET, (uint8_t *)eeprom, 0, eeprom_size);
  avr_reset(avr);
  b->report.resets = 0;
  return b;
}

void bench_close(Bench *b) {
  avr_terminate(b->avr);
  free(b->edges);
  free(b->sent);
  free(b->queue);
  free(b->avr);
  free(b);
}

static avr_cycle_count_t on_time(avr_t *avr, avr_cycle_count_t when, void *param) {
  (void)avr, (void)when, (void)param;
  return 0;
}

// Runs until this cycle; the last instruction may end later. Returns libsimavr's state: 6 and 7 mean that the program
// has ended.
int bench_run(Bench *b, uint64_t until) {
  avr_t *avr = b->avr;
  if (avr->cycle < until) avr_cycle_timer_register(avr, until - avr->cycle, on_time, b);
  while (avr->cycle < until && avr->state != cpu_Done && avr->state != cpu_Crashed) {
    if (b->fresh) {
      prepare(b);
      avr_cycle_timer_register(avr, until - avr->cycle, on_time, b);
    }
    avr_run(avr);
  }
  avr_cycle_timer_cancel(avr, on_time, b);
  b->report.cycle = avr->cycle;
  return avr->state;
}

void bench_reset(Bench *b) { avr_reset(b->avr); }

// Queues bytes for the board. The first begins now, or after the queued ones.
void bench_send(Bench *b, const uint8_t *bytes, uint32_t count, uint64_t byte_cycles) {
  if (!count) return;
  bool idle = b->queue_head == b->queue_tail;
  if (b->queue_tail + count > b->queue_room) {
    b->queue_room = 2 * (b->queue_tail + count);
    b->queue = realloc(b->queue, b->queue_room);
  }
  memcpy(b->queue + b->queue_tail, bytes, count);
  b->queue_tail += count;
  b->report.unread = b->queue_tail - b->queue_head;
  b->byte_cycles = byte_cycles;
  if (idle) avr_cycle_timer_register(b->avr, byte_cycles, on_byte, b);
}

// Copies the complete bytes from the board since the last call; returns their number, at most `room`.
uint32_t bench_receive(Bench *b, uint8_t *bytes, uint32_t room) {
  uint32_t count = 0;
  while (count < room && b->taken < b->report.sent && b->sent[b->taken].cycle <= b->avr->cycle) {
    bytes[count++] = b->sent[b->taken++].byte;
  }
  return count;
}

const Report *bench_report(Bench *b) { return &b->report; }
const Edge *bench_edges(Bench *b) { return b->edges; }
const Byte *bench_sent(Bench *b) { return b->sent; }
void bench_eeprom(Bench *b, uint8_t *bytes, uint32_t size) { use_eeprom(b, AVR_IOCTL_EEPROM_GET, bytes, 0, size); }

void bench_analogue(Bench *b, uint8_t input, uint32_t millivolts) {
  b->millivolts[input] = millivolts;
  avr_raise_irq(avr_io_getirq(b->avr, AVR_IOCTL_ADC_GETIRQ, input), millivolts);
}

// Returns whether no interrupt is running: the main loop runs or sleeps.
int bench_in_main(Bench *b) { return b->depth == 0; }
// Overwrites the next instruction with a jump to itself; returns the old one, for bench_mend().
uint32_t bench_hang(Bench *b) {
  uint8_t *at = b->avr->flash + b->avr->pc;
  uint32_t was = at[0] | at[1] << 8;
  at[0] = 0xFF, at[1] = 0xCF;
  return b->avr->pc << 16 | was;
}
void bench_mend(Bench *b, uint32_t was) {
  b->avr->flash[was >> 16] = was & 0xFF;
  b->avr->flash[(was >> 16) + 1] = was >> 8 & 0xFF;
}
