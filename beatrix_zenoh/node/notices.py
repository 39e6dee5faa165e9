"""What went wrong lately without anybody to tell."""

from __future__ import annotations

import time
from collections import deque

SHOWN_S = 10.0
LENGTH = 5


class Notices:
    """The last sentences for status; written on one thread, read on any."""

    def __init__(self) -> None:
        self._told: deque[tuple[float, str]] = deque(maxlen=LENGTH)

    def add(self, text: str) -> None:
        """Show it for a while; the same sentence again only begins its time anew."""
        if self._told and self._told[-1][1] == text:
            self._told.pop()
        self._told.append((time.monotonic(), text))

    def recent(self) -> list[str]:
        """Those of the last seconds."""
        now = time.monotonic()
        return [text for at, text in list(self._told) if now - at < SHOWN_S]
