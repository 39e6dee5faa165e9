"""STK500 version 2, as the boot loader of the Arduino Mega 2560 speaks it (Atmel AVR068, "STK500 Communication Protocol").

A message: 0x1B, sequence number, size (2 bytes, high first), 0x0E, body, XOR of all before. Every command is
answered with its own number and a status.
"""

from __future__ import annotations

import time
from functools import reduce
from operator import xor
from typing import Final, Protocol

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import NoAnswer

BAUD: Final = 115_200
PAGE: Final = 256
"""Bytes erased and written at once."""
FLASH: Final = 0x3E000
"""Bytes for the firmware; above is the boot loader."""
SIGNATURE: Final = b"\x1e\x98\x01"
"""ATmega2560."""
LOADER: Final = b"AVRISP_2"
SIGN_ON, LOAD_ADDRESS, ENTER, LEAVE, ERASE, PROGRAM, READ, SPI = (
    0x01,
    0x06,
    0x10,
    0x11,
    0x12,
    0x13,
    0x14,
    0x1D,
)
STATUS_OK: Final = 0
PARKED: Final = b"\xff\xcf".ljust(PAGE, b"\xff")
"""A first page that is but an endless loop, `rjmp .-2`: pins stay as reset left them."""
START, TOKEN = 0x1B, 0x0E
OVERHEAD: Final = 6
FAR: Final = 1 << 31
"""In an address: it may lie beyond 64 Ki words."""
HELLO_S: Final = 0.25
HELLO_TRIES: Final = 12
ANSWER_S: Final = 1.0
TRIES: Final = 5


class Wire(Protocol):
    """A serial port, and the clock of whoever is at its other end."""

    def write(self, data: bytes) -> object:
        """Send all of it."""

    def read(self, timeout_s: float) -> bytes:
        """What has come, waiting up to `timeout_s` for the first byte."""

    def reset_board(self) -> None:
        """Pull the reset line; the boot loader starts."""


class Programmer:
    """Writes and reads the flash of a board that has just been reset.

    Raises NoAnswer (BOARD_LOST, TIMED_OUT) from every method if the boot loader does not answer as it should.
    """

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self._sequence = 0

    def sign_on(self) -> None:
        """Find the boot loader, which listens for a second after a reset, and the chip it is on."""
        for _ in range(HELLO_TRIES):
            answer = self._try(bytes([SIGN_ON]), HELLO_S)
            if answer is not None and answer.endswith(LOADER):
                break
        else:
            raise NoAnswer(
                Reason.TIMED_OUT,
                "The board's boot loader does not answer: is it an Arduino Mega 2560, and the right port? Press its reset "
                "button just when you start, if it does not reset by itself.",
            )
        self._ask(bytes([ENTER, 200, 100, 25, 32, 0, 0x53, 3, 0xAC, 0x53, 0, 0]))
        found = bytes(self._ask(bytes([SPI, 4, 4, 0, 0x30, 0, index, 0]))[5] for index in range(3))
        if found != SIGNATURE:
            raise NoAnswer(
                Reason.BOARD_LOST,
                f"The chip is {found.hex()}, not the ATmega2560 ({SIGNATURE.hex()}).",
            )

    def write(self, at: int, page: bytes) -> None:
        """Write one page of PAGE bytes. The boot loader erases it first: for some milliseconds it is blank."""
        self._at(at, bytes([PROGRAM, PAGE >> 8, PAGE & 0xFF, 0xC1, 10, 0x40, 0x4C, 0x20, 0, 0]) + page)

    def check(self, at: int, page: bytes) -> None:
        """Read one page back and compare it."""
        # More than once: two errors on the wire can leave the XOR as it was.
        if not any(self._read(at) == page for _ in range(TRIES)):
            raise NoAnswer(
                Reason.BOARD_LOST, f"The board reads back something else at {at:#x} than was written."
            )

    def _read(self, at: int) -> bytes:
        return self._at(at, bytes([READ, PAGE >> 8, PAGE & 0xFF, 0x20]))[2 : 2 + PAGE]

    def leave(self) -> None:
        """Start the firmware."""
        self._ask(bytes([LEAVE, 1, 1]))

    def _at(self, at: int, body: bytes) -> bytes:
        """Ask about this address; both again if an answer is lost, for the boot loader has moved on."""
        for _ in range(TRIES):
            if at == 0 and body[0] == PROGRAM:
                # With every page it writes, the boot loader erases the next one, wherever it writes; begin anew.
                self._answer(bytes([ERASE, 0, 0, 0, 0, 0, 0]))
            self._ask(bytes([LOAD_ADDRESS]) + (FAR | at // 2).to_bytes(4, "big"))
            answer = self._try(body, ANSWER_S)
            if answer is not None and answer[1] == STATUS_OK:
                return answer
        raise gone()

    def _ask(self, body: bytes) -> bytes:
        answer = self._answer(body)
        if answer[1] != STATUS_OK:
            raise NoAnswer(Reason.BOARD_LOST, f"The board's boot loader refused command {body[0]:#04x}.")
        return answer

    def _answer(self, body: bytes) -> bytes:
        """Whatever it says of it: it calls the erase command failed, and obeys."""
        for _ in range(TRIES):
            answer = self._try(body, ANSWER_S)
            if answer is not None:
                return answer
        raise gone()

    def _try(self, body: bytes, timeout_s: float) -> bytes | None:
        """The body of the answer, None if it did not come, whole and good, in time."""
        self._sequence = (self._sequence + 1) % 256
        message = bytes([START, self._sequence]) + len(body).to_bytes(2, "big") + bytes([TOKEN]) + body
        self._wire.write(message + bytes([reduce(xor, message)]))
        heard = b""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            data = self._wire.read(max(0.0, deadline - time.monotonic()))
            if not data:
                return None
            heard += data
            answer = find(heard, self._sequence)
            if answer is not None:
                return answer if answer[0] == body[0] and len(answer) > 1 else None
        return None


def gone() -> NoAnswer:
    """What to tell when it falls silent."""
    return NoAnswer(Reason.BOARD_LOST, "The board's boot loader does not answer any more.")


def find(heard: bytes, sequence: int) -> bytes | None:
    """The body of a whole message with this number among what was heard; None if there is none yet."""
    for begin in range(len(heard)):
        message = heard[begin:]
        if message[:2] != bytes([START, sequence]) or len(message) < OVERHEAD or message[4] != TOKEN:
            continue
        end = OVERHEAD - 1 + int.from_bytes(message[2:4], "big")
        if len(message) > end and reduce(xor, message[:end]) == message[end] and end >= OVERHEAD:
            return message[OVERHEAD - 1 : end]
    return None
