"""What went wrong lately without anybody to tell."""

from __future__ import annotations

import time
from collections import deque

SHOWN_S = 10.0
LENGTH = 5
RESTARTED = "The board was restarted and knows no home: set the head upright, enable, calibrate."


class Notices:
    """The last sentences for status; written on one thread, read on any."""

    def __init__(self) -> None:
        self._told: deque[tuple[float, str]] = deque(maxlen=LENGTH)
        self._boot = 0

    def add(self, text: str) -> None:
        """Show it for a while; the same sentence again only begins its time anew."""
        if self._told and self._told[-1][1] == text:
            self._told.pop()
        self._told.append((time.monotonic(), text))

    def started(self, boot: int, *, home_known: bool) -> None:
        """The board says how often it was started: once more than before is worth a sentence, until home is known."""
        if self._boot and boot != self._boot:
            self.add(RESTARTED)
        self._boot = boot
        if home_known:
            self._told = deque((told for told in self._told if told[1] != RESTARTED), maxlen=LENGTH)

    def recent(self) -> list[str]:
        """Those of the last seconds."""
        now = time.monotonic()
        return [text for at, text in list(self._told) if now - at < SHOWN_S]
