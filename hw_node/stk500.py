"""STK500 version 2, the protocol of the Arduino Mega's boot loader (Atmel AVR068, "STK500 Communication Protocol").

A message consists of 0x1B, sequence number, size (2 bytes, big-endian), 0x0E, body, XOR of all bytes before. The reply
to a command has the sequence number of the command, and contains a status.
"""

from __future__ import annotations

import time
from functools import reduce
from operator import xor
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from hw_node.port import SerialPort

BAUD: Final = 115_200
PAGE: Final = 256
"""Bytes that are erased and written together."""
FLASH: Final = 0x3E000
"""Bytes for the firmware; the boot loader is above."""
SIGNATURE: Final = b"\x1e\x98\x01"
"""ATmega2560."""
LOADER: Final = b"AVRISP_2"
SIGN_ON, LOAD_ADDRESS = 0x01, 0x06
ENTER, LEAVE, ERASE, PROGRAM, READ = range(0x10, 0x15)
SPI: Final = 0x1D
STATUS_OK: Final = 0
PARKED: Final = b"\xff\xcf".ljust(PAGE, b"\xff")
"""A first page with an endless loop, `rjmp .-2`: the pins keep their reset state."""
START, TOKEN = 0x1B, 0x0E
OVERHEAD: Final = 6
FAR: Final = 1 << 31
"""Flag in an address that may be beyond 64 Ki words."""
SIGN_ON_S: Final = 0.25
SIGN_ON_TRIES: Final = 12
REPLY_S: Final = 1.0
TRIES: Final = 5


class Programmer:
    """Writes and reads the flash of a board that has just been reset.

    Every method raises NoAnswer (BOARD_LOST, TIMED_OUT) if the boot loader does not answer correctly.
    """

    def __init__(self, port: SerialPort) -> None:
        self._port = port
        self._sequence = 0

    def sign_on(self) -> None:
        """Connect to the boot loader, which waits for a second after a reset, and check the chip."""
        for _ in range(SIGN_ON_TRIES):
            reply = self._try(bytes([SIGN_ON]), SIGN_ON_S)
            if reply is not None and reply.endswith(LOADER):
                break
        else:
            raise NoAnswer(
                Reason.TIMED_OUT,
                "The boot loader does not answer. Check that the board is an Arduino Mega 2560 and the port is right. If the "
                "board does not reset by itself, press its reset button when you start `beatrix flash`.",
            )
        self._command(bytes([ENTER, 200, 100, 25, 32, 0, 0x53, 3, 0xAC, 0x53, 0, 0]))
        found = bytes(self._command(bytes([SPI, 4, 4, 0, 0x30, 0, index, 0]))[5] for index in range(3))
        if found != SIGNATURE:
            text = f"The chip is {found.hex()}, not the ATmega2560 ({SIGNATURE.hex()})."
            raise NoAnswer(Reason.BOARD_LOST, text)

    def write(self, at: int, page: bytes) -> None:
        """Write one page of PAGE bytes. The boot loader erases it first, so it is blank for some milliseconds."""
        self._at(at, bytes([PROGRAM, PAGE >> 8, PAGE & 0xFF, 0xC1, 10, 0x40, 0x4C, 0x20, 0, 0]) + page)

    def check(self, at: int, page: bytes) -> None:
        """Read one page back and compare it with `page`."""
        # Repeated, because the XOR does not detect every transmission error.
        if not any(self._read(at) == page for _ in range(TRIES)):
            raise NoAnswer(
                Reason.BOARD_LOST, f"The board reads back other bytes at {at:#x} than were written."
            )

    def _read(self, at: int) -> bytes:
        return self._at(at, bytes([READ, PAGE >> 8, PAGE & 0xFF, 0x20]))[2 : 2 + PAGE]

    def leave(self) -> None:
        """Start the firmware."""
        self._command(bytes([LEAVE, 1, 1]))

    def _at(self, at: int, body: bytes) -> bytes:
        """Set the address and send a command for it; return the reply.

        If a reply is lost, both are sent again, because the boot loader may have advanced its address.
        """
        for _ in range(TRIES):
            if at == 0 and body[0] == PROGRAM:
                # At each write, the boot loader erases the page at a counter of its own, and advances that counter.
                # This command, for which it reports a failure, sets the counter to 0.
                self._command(bytes([ERASE, 0, 0, 0, 0, 0, 0]), works=False)
            self._command(bytes([LOAD_ADDRESS]) + (FAR | at // 2).to_bytes(4, "big"))
            reply = self._try(body, REPLY_S)
            if reply is not None and reply[1] == STATUS_OK:
                return reply
        raise lost()

    def _command(self, body: bytes, *, works: bool = True) -> bytes:
        """Send a command until it is answered, and return the reply; with `works` until it has succeeded."""
        for _ in range(TRIES):
            reply = self._try(body, REPLY_S)
            if reply is not None and (reply[1] == STATUS_OK or not works):
                return reply
        raise lost()

    def _try(self, body: bytes, timeout_s: float) -> bytes | None:
        """Send a command once and return the body of the reply; None if no valid reply arrives in time."""
        self._sequence = (self._sequence + 1) % 256
        message = bytes([START, self._sequence]) + len(body).to_bytes(2, "big") + bytes([TOKEN]) + body
        self._port.write(message + bytes([reduce(xor, message)]))
        received = b""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            data = self._port.read(max(0.0, deadline - time.monotonic()))
            if not data:
                return None
            received += data
            reply = find(received, self._sequence)
            if reply is not None:
                return reply if reply[0] == body[0] and len(reply) > 1 else None
        return None


def lost() -> NoAnswer:
    """Return the error for a boot loader that no longer replies."""
    return NoAnswer(Reason.BOARD_LOST, "The boot loader does not answer any more.")


def find(received: bytes, sequence: int) -> bytes | None:
    """Return the body of a complete message with this number in the received bytes; None if there is none."""
    for begin in range(len(received)):
        message = received[begin:]
        if message[:2] != bytes([START, sequence]) or len(message) < OVERHEAD or message[4] != TOKEN:
            continue
        end = OVERHEAD - 1 + int.from_bytes(message[2:4], "big")
        if len(message) > end and reduce(xor, message[:end]) == message[end] and end >= OVERHEAD:
            return message[OVERHEAD - 1 : end]
    return None
