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
        self._restarted = False

    def add(self, text: str) -> None:
        """Show it for a while; the same sentence again only begins its time anew."""
        others = [told for told in self._told if told[1] != text]
        self._told = deque([*others, (time.monotonic(), text)], maxlen=LENGTH)

    def started(self, boot: int, *, home_known: bool) -> None:
        """The board says how often it was started: once more than before is told until home is known."""
        self._restarted = not home_known and (self._restarted or bool(self._boot and boot != self._boot))
        self._boot = boot

    def recent(self) -> list[str]:
        """What still holds, and the sentences of the last seconds."""
        now = time.monotonic()
        lately = [text for at, text in list(self._told) if now - at < SHOWN_S]
        return [RESTARTED, *lately] if self._restarted else lately
