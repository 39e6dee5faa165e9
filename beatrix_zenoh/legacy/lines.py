"""Lines that programs of 2023 write, and what receives them."""

from __future__ import annotations

import time
from typing import Protocol

from beatrix_zenoh.contract._generated import serial as wire

LINE_END_S = wire.TEXT_LINE_TIMEOUT / 1000
"""Time without a byte after which an incomplete line is dropped (s)."""
BLANKS = b" \t"
"""Characters that the firmware skips at the start of a line."""


class TerminalListener(Protocol):
    """Receives the lines of programs; its methods are called on the terminal's thread, in order."""

    def opened(self) -> None:
        """Handle a program that has opened the terminal.

        `write` drops all answers until `begin_answers` is called once.
        """

    def received(self, line: bytes) -> None:
        """Handle a line of the program; `line` has no line end and no leading blanks, and is never empty."""

    def closed(self) -> None:
        """Handle the end of the program, or a program that has closed the terminal."""


class LineSplitter:
    """Splits the bytes that a program writes into lines."""

    def __init__(self) -> None:
        self._begun = b""
        self._written_s = 0.0

    def split(self, data: bytes) -> list[bytes]:
        """Return the lines that end in `data`, without line ends and leading blanks; `data` may be empty."""
        now_s = time.monotonic()
        if not data and now_s - self._written_s >= LINE_END_S:
            self._begun = b""
        if not data:
            return []
        self._written_s = now_s
        *lines, rest = (self._begun + data).replace(b"\n", b"\r").split(b"\r")
        self._begun = rest.lstrip(BLANKS)[: wire.TEXT_LINE_MAX + 1]
        return [line for text in lines if (line := text.lstrip(BLANKS))]
