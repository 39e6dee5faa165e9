"""The firmware on a simulated Arduino Mega, in virtual time with exact cycles."""

from __future__ import annotations

import ctypes
import os
import subprocess
from functools import cache
from pathlib import Path
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

HERE: Final = Path(__file__).resolve().parent
BUILD: Final = HERE.parents[1] / "build/avr"
CYCLES_PER_MS: Final = 16_000
EEPROM_SIZE: Final = 4096
SIGNALS: Final = ("step", "direction", "enable")
VECTORS: Final = {17: "step x", 18: "step y", 19: "step z", 25: "receive", 26: "transmit", 32: "tick"}
"""Interrupts of the firmware by their number on the ATmega2560."""
BUDGETS: Final = {"step x": 300, "step y": 300, "step z": 300, "receive": 100, "transmit": 100, "tick": 8000}
"""Cycles per call that firmware/beatrix/src/core/hal.h allows; a step interrupt may spend half of them waiting."""
TICK: Final = 32
_ENDED_STATES: Final = (6, 7)
"""States of libsimavr: the program ended, or crashed."""
_RECEIVE_SIZE: Final = 4096
"""Largest number of bytes that one call fetches."""
_PIECE: Final = 16_000_000
"""Cycles for each call into C, so that Python can handle a keyboard interrupt."""

Steps = tuple[int, int, int]


class Work(ctypes.Structure):
    """Calls of an interrupt and their cycles, without those of nested interrupts; it changes while the board runs."""

    longest: int
    last: int
    """cycle at which the last call began"""
    _fields_ = (
        ("calls", ctypes.c_uint64),
        ("cycles", ctypes.c_uint64),
        ("longest", ctypes.c_uint64),
        ("last", ctypes.c_uint64),
    )


class _Report(ctypes.Structure):
    _fields_ = (
        ("cycle", ctypes.c_uint64),
        ("slept", ctypes.c_uint64),
        ("edges", ctypes.c_uint64),
        ("sent", ctypes.c_uint64),
        ("overruns", ctypes.c_uint64),
        ("resets", ctypes.c_uint64),
        ("unread", ctypes.c_uint64),
        ("work", Work * 64),
        ("levels", ctypes.c_uint8 * 7),
    )


EDGE: Final = np.dtype([("cycle", "<u8"), ("signal", "u1"), ("level", "u1")], align=True)
BYTE: Final = np.dtype([("cycle", "<u8"), ("byte", "u1")], align=True)


@cache
def _library() -> ctypes.CDLL:
    """Return the library of mega.c, compiled if mega.c is newer; processes may compile it at the same time."""
    BUILD.mkdir(parents=True, exist_ok=True)
    source, library = HERE / "mega.c", BUILD / "mega.so"
    if not library.exists() or library.stat().st_mtime < source.stat().st_mtime:
        fresh = BUILD / f"mega-{os.getpid()}.so"
        options = ["-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-Werror"]
        subprocess.run(["cc", *options, source, "-o", fresh, "-lsimavr", "-lelf"], check=True)
        fresh.rename(library)
    found = ctypes.CDLL(str(library))
    pointer, number = ctypes.c_void_p, ctypes.c_uint32
    found.bench_open.restype = pointer
    found.bench_open.argtypes = [ctypes.c_char_p, ctypes.c_char_p, number]
    found.bench_run.argtypes = [pointer, ctypes.c_uint64]
    found.bench_send.argtypes = [pointer, ctypes.c_char_p, number, ctypes.c_uint64]
    found.bench_receive.argtypes = [pointer, ctypes.c_char_p, number]
    found.bench_receive.restype = number
    found.bench_report.restype = ctypes.POINTER(_Report)
    found.bench_edges.restype = found.bench_sent.restype = pointer
    found.bench_hang.restype = number
    for name in ("close", "reset", "report", "edges", "sent", "in_main", "hang"):
        getattr(found, f"bench_{name}").argtypes = [pointer]
    found.bench_eeprom.argtypes = [pointer, ctypes.c_char_p, number]
    found.bench_mend.argtypes = [pointer, number]
    return found


class Avr:
    """An Arduino Mega with this firmware (.elf or .hex), after reset. Use it in `with`.

    Times are cycles of 62.5 ns since power-on, or milliseconds of 16 000 cycles. `eeprom` is the initial content of the
    EEPROM, by default erased. Methods that run the program raise AssertionError if it ends or crashes.
    """

    def __init__(self, firmware: Path, eeprom: bytes = b"\xff" * EEPROM_SIZE, baud: int = 250_000) -> None:
        self._c = _library()
        self._board: int | None = self._c.bench_open(str(firmware).encode(), eeprom, len(eeprom))
        assert self._board, f"{firmware}: libsimavr cannot load this file"
        self._report = self._c.bench_report(self._board).contents
        self.byte_cycles = round(16_000_000 * 10 / baud)
        """Cycles of a byte on the host's wire: 10 bits."""
        self._receive_buffer = ctypes.create_string_buffer(_RECEIVE_SIZE)
        self._wire_free = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def close(self) -> None:
        """Free the simulator; the object is unusable afterwards."""
        if self._board:
            self._c.bench_close(self._board)
            self._board = None

    # --- time

    @property
    def cycle(self) -> int:
        """Cycles since power-on, resets included."""
        return int(self._report.cycle)

    def run_until(self, cycle: int) -> None:
        """Run until this cycle; the last instruction may end later."""
        while self.cycle < cycle:
            state = self._c.bench_run(self._board, min(cycle, self.cycle + _PIECE))
            if state in _ENDED_STATES:
                raise AssertionError(f"state {state} at cycle {self.cycle}")

    def run(self, cycles: int) -> None:
        """Run for this number of cycles."""
        self.run_until(self.cycle + cycles)

    def run_ms(self, ms: float) -> None:
        """Run for this number of milliseconds."""
        self.run(round(ms * CYCLES_PER_MS))

    # --- serial line

    def send(self, data: bytes) -> int:
        """Queue bytes on the serial line; return the cycle at which the last stop bit ends."""
        start = max(self.cycle, self._wire_free)
        self._c.bench_send(self._board, data, len(data), self.byte_cycles)
        self._wire_free = start + len(data) * self.byte_cycles
        return self._wire_free

    def deliver(self, data: bytes) -> None:
        """Send bytes, and run until the board has received the last one."""
        self.run_until(self.send(data))

    def sent(self) -> NDArray[np.void]:
        """Return all bytes from the board: fields `cycle` (of the stop bit) and `byte`."""
        return copied(self._c.bench_sent(self._board), int(self._report.sent), BYTE)

    def receive(self) -> bytes:
        """Return the complete bytes from the board since the last call."""
        received = b""
        while count := self._c.bench_receive(self._board, self._receive_buffer, _RECEIVE_SIZE):
            received += self._receive_buffer.raw[:count]
        return received

    @property
    def overruns(self) -> int:
        """Bytes that the UART lost because the firmware had not read earlier ones."""
        return int(self._report.overruns)

    # --- pins

    def edges(self, signal: str, arm: int = 0) -> NDArray[np.void]:
        """Return the changes of a wire ("step", "direction", "enable"): fields `cycle` and `level`."""
        edges = self.all_edges()
        chosen: NDArray[np.void] = edges[edges["signal"] == 3 * SIGNALS.index(signal) + arm]
        return chosen

    def all_edges(self) -> NDArray[np.void]:
        """Return the changes of all wires in order; `signal` is 0 to 2 for step, 3 to 5 for direction, 6 for enable."""
        return copied(self._c.bench_edges(self._board), int(self._report.edges), EDGE)

    @property
    def enabled(self) -> bool:
        """Whether the drivers are on: their wire is low."""
        return int(self._report.levels[6]) == 0

    def steps(self, arm: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the start cycles of an arm's steps, and their directions, +1 or -1."""
        edges = self.all_edges()
        steps = edges[(edges["signal"] == arm) & (edges["level"] == 1)]["cycle"].astype(np.int64)
        turns = edges[edges["signal"] == 3 + arm]
        # Before its first change the wire is low, which means backward.
        levels = np.concatenate([[0], turns["level"]])
        forward = levels[np.searchsorted(turns["cycle"].astype(np.int64), steps, side="right")]
        return steps, np.where(forward == 1, 1, -1)

    def pulses(self) -> Steps:
        """Return the steps on the pins of each arm since power-on, forward minus backward."""
        x, y, z = (int(self.steps(arm)[1].sum()) for arm in range(3))
        return x, y, z

    # --- the rest of the board

    def reset(self) -> None:
        """Press the reset button."""
        self._c.bench_reset(self._board)

    @property
    def resets(self) -> int:
        """Resets since power-on, by button or watchdog."""
        return int(self._report.resets)

    @property
    def eeprom(self) -> bytes:
        """Content of the EEPROM."""
        held = ctypes.create_string_buffer(EEPROM_SIZE)
        self._c.bench_eeprom(self._board, held, EEPROM_SIZE)
        return held.raw

    def hang(self) -> int:
        """Replace the next instruction of the main loop by a jump to itself; return the old one, for `mend`.

        Interrupts continue.
        """
        for _ in range(1000):
            if self._c.bench_in_main(self._board):
                return int(self._c.bench_hang(self._board))
            self.run(20)
        raise AssertionError("the main loop never runs")

    def mend(self, broken: int) -> None:
        """Restore the instruction that `hang` has replaced."""
        self._c.bench_mend(self._board, broken)

    # --- processor time

    @property
    def slept(self) -> int:
        """Cycles in which the processor slept."""
        return int(self._report.slept)

    def work(self, vector: int) -> Work:
        """Return calls and cycles of an interrupt since power-on; see VECTORS."""
        found: Work = self._report.work[vector]
        return found


def copied(address: int | None, count: int, kind: np.dtype[np.void]) -> NDArray[np.void]:
    """Return a copy of an array of the library."""
    if not count or not address:
        return np.empty(0, kind)
    found: NDArray[np.void] = np.frombuffer(ctypes.string_at(address, count * kind.itemsize), kind)
    return found
