"""When a board that is not understood yet may be spoken to, without any input or output: times in, decisions out.

Opening a port resets most boards, a button resets every board, and then the boot loader listens first: for 0.9 s if
nobody speaks. Whoever speaks keeps it listening for 5 s more (measured on the Mega's own boot loader). So a board that
may have been reset is left in silence first; and one whose host has gone deaf stops its motion in it, for want of a
heartbeat. Only firmware sends frames: as soon as one comes, nobody has to wait.
"""

from __future__ import annotations

import math
from typing import Final

BOOT_S: Final = 1.2
"""After a reset that nobody has spoken into."""
LOADER_S: Final = 6.0
"""After the last word that a boot loader may have heard."""
HELLO_S: Final = 0.2
TRIES: Final = 3
"""Greetings before the next silence: noise may spoil one."""
STRANGER_S: Final = 1.0
"""Firmware of another contract is greeted this rarely: a motion that another host has left behind shall end for want of
a heartbeat."""


class Greeting:
    """The times of HELLO for one opening of a port; all times are monotonic, s."""

    def __init__(self, opened_s: float, boot_s: float) -> None:
        """Opened now; the board needs `boot_s` to start."""
        self._next_s = opened_s + boot_s
        self._said_s = -math.inf
        self._said = 0

    def due(self, now_s: float) -> bool:
        """HELLO may be said."""
        return now_s >= self._next_s

    def said(self, now_s: float, *, stranger: bool) -> None:
        """HELLO was said, to firmware of another contract or to nobody known."""
        self._said_s = now_s
        self._said += 1
        if stranger:
            self._next_s = now_s + STRANGER_S
        else:
            self._next_s = now_s + (HELLO_S if self._said % TRIES else LOADER_S)

    def heard(self) -> None:
        """A frame came from a board that is not known: firmware runs."""
        self._next_s = min(self._next_s, self._said_s + HELLO_S)

    def spoken(self, now_s: float) -> None:
        """Something else was said to a board that is not known: STOP, which is never withheld."""
        self._next_s = max(self._next_s, now_s + LOADER_S)

    def lost(self, now_s: float) -> None:
        """The board has fallen silent, and may have been spoken to in its boot loader."""
        self._next_s, self._said = now_s + LOADER_S, 0
