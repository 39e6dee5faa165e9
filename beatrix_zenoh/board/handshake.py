"""Compute when HELLO may be sent to a board. No I/O; callers pass the time.

Opening a port resets most boards, and so does the reset button. After a reset the boot loader runs first: for 0.9 s if
it receives nothing, and for 5 s more after each byte it receives (measured on the Mega's boot loader). The host
therefore sends nothing at first to a board that may have been reset. A motion that still runs ends in this pause,
because the firmware misses the heartbeat. Only firmware sends frames: the first frame ends the pause.
"""

from __future__ import annotations

import math
from typing import Final

BOOT_S: Final = 1.2
"""Pause after a reset if no byte was sent since the reset."""
LOADER_S: Final = 6.0
"""Pause after the last byte that a boot loader may have received."""
HELLO_S: Final = 0.2
"""Pause between two HELLOs."""
TRIES: Final = 3
"""Number of HELLOs before the next long pause, because noise may damage one."""
FOREIGN_S: Final = 1.0
"""Pause between HELLOs to firmware of another contract: longer than the heartbeat timeout, so that the motion of
another host ends."""


class Handshake:
    """The times of HELLO for one opening of a port; all times are monotonic (s)."""

    def __init__(self, opened_s: float, boot_s: float) -> None:
        """Begin at `opened_s`; the board needs `boot_s` to start."""
        self._next_s = opened_s + boot_s
        self._hello_s = -math.inf
        self._hellos = 0

    def due(self, now_s: float) -> bool:
        """Return whether HELLO may be sent."""
        return now_s >= self._next_s

    def hello_sent(self, now_s: float, *, foreign: bool) -> None:
        """Record a HELLO; `foreign`: the firmware has another contract."""
        self._hello_s = now_s
        self._hellos += 1
        if foreign:
            self._next_s = now_s + FOREIGN_S
        else:
            self._next_s = now_s + (HELLO_S if self._hellos % TRIES else LOADER_S)

    def frame_received(self) -> None:
        """Record a frame from a board whose contract is unknown: its firmware runs, so end a long pause."""
        self._next_s = min(self._next_s, self._hello_s + HELLO_S)

    def request_sent(self, now_s: float) -> None:
        """Postpone HELLO after a request to a board whose contract is unknown.

        STOP and EMERGENCY_STOP are sent even to such a board.
        """
        self._next_s = max(self._next_s, now_s + LOADER_S)

    def lost(self, now_s: float) -> None:
        """Record that the board became silent; its boot loader may have received bytes."""
        self._next_s, self._hellos = now_s + LOADER_S, 0
