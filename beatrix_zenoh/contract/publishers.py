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
LATE: Final = 16
"""A publication that others of the same program have overtaken is at most this many numbers late."""


class Publishers:
    """Counts how often the numbers of a stream go back. Two programs that count alike are not told apart."""

    def __init__(self) -> None:
        self._order = Order()
        self._received = 0
        self._back: deque[int] = deque(maxlen=TIMES)

    def several(self, seq: int) -> bool:
        """Return whether several programs publish now; `seq` is the number of the newest publication."""
        self._received += 1
        if self._order.goes_back(seq):
            self._back.append(self._received)
        return len(self._back) == TIMES and self._received - self._back[0] < WITHIN


class Order:
    """The order of the numbers of one stream. The network may deliver publications in another order."""

    def __init__(self) -> None:
        self._newest: int | None = None
        self._skipped: deque[int] = deque(maxlen=LATE)
        self._seen: deque[int] = deque(maxlen=4 * LATE)
        self.missing = 0
        """Count of numbers that were skipped and have not come later."""

    def goes_back(self, seq: int) -> bool:
        """Return whether a number is before the newest one without having been skipped; 0 comes after the largest."""
        step = 0 if self._newest is None else (seq - self._newest) % NUMBERS
        if step >= NUMBERS // 2 and seq in self._skipped:
            self._skipped.remove(seq)
            self._seen.append(seq)
            self.missing -= 1
            return False
        back = step >= NUMBERS // 2
        if back:
            self._skipped.clear()
        elif step > 1:
            # Of two programs that are close to each other, one has published what the other seems to skip.
            between = ((seq - late) % NUMBERS for late in range(min(step - 1, LATE), 0, -1))
            self._skipped.extend(number for number in between if number not in self._seen)
            self.missing += step - 1
        self._newest = seq
        self._seen.append(seq)
        return back

    def restart(self) -> None:
        """Expect any number."""
        self._newest = None
        self._skipped.clear()
        self._seen.clear()
