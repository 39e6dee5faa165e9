"""Finds out, from sequence numbers, that two programs publish under one key."""

from __future__ import annotations

from collections import deque
from typing import Final

NUMBERS: Final = 2**32
"""Sequence numbers are counted modulo this."""
TIMES: Final = 3
"""A node that is restarted begins its numbers again once. Two programs make them go back this many times within WITHIN."""
WITHIN: Final = 100
"""Number of publications: positions of one second of two programs."""


class Publishers:
    """Counts how often the numbers of a stream go back. Two programs that count alike are not told apart."""

    def __init__(self) -> None:
        self._last: int | None = None
        self._received = 0
        self._back: deque[int] = deque(maxlen=TIMES)

    def several(self, seq: int) -> bool:
        """Return whether several programs publish now; `seq` is the number of the newest publication."""
        self._received += 1
        if self._last is not None and goes_back(self._last, seq):
            self._back.append(self._received)
        self._last = seq
        return len(self._back) == TIMES and self._received - self._back[0] < WITHIN


def goes_back(before: int, seq: int) -> bool:
    """Return whether a number is before the one of the last publication; 0 comes after the largest."""
    return (seq - before) % NUMBERS >= NUMBERS // 2
