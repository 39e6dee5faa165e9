"""Sentences about a check that takes long, every few seconds."""

from __future__ import annotations

import time
from collections.abc import Callable

from beatrix_zenoh.lessons.phrases import Phrase, phrase

EVERY_S = 10.0

Tell = Callable[[Phrase], None]


class Still:
    """Says every EVERY_S what is going on, with the seconds that are left, or that the caller gives."""

    def __init__(self, tell: Tell, key: str, limit_s: float = 0.0, **values: object) -> None:
        """Prepare a phrase that needs `seconds` and these values."""
        self._tell, self._key, self._values = tell, key, values
        self._next_s = time.monotonic() + EVERY_S
        self._end_s = time.monotonic() + limit_s

    def look(self, seconds: float | None = None) -> None:
        """Say it if it is due; None: with the seconds that are left of the limit."""
        now_s = time.monotonic()
        if now_s >= self._next_s:
            self._next_s = now_s + EVERY_S
            left = self._end_s - now_s if seconds is None else seconds
            self._tell(phrase(self._key, seconds=left, **self._values))
