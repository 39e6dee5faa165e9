"""Times of a board: when HELLO may be sent, and its ticks on the host's clock. No I/O; callers pass the time.

Opening a port resets most boards, and so does the reset button. After a reset the boot loader runs first: for 0.9 s if
it receives nothing, and for 5 s more after each byte it receives (measured on the Mega's boot loader). The host
therefore sends nothing at first to a board that may have been reset. A motion that still runs ends in this pause,
because the firmware misses the heartbeat. Only firmware sends frames: the first frame ends the pause.
"""

from __future__ import annotations

import math
from collections import deque
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


_WRAP: Final = 2**16
_MS: Final = 1_000_000
_WINDOW_NS: Final = 1_000_000_000
"""Age up to which a minimum is used; in this time a drift of 1000 ppm shifts it by 1 ms."""
_JUMP_NS: Final = 60_000_000
"""_JUMPS offsets in a row that exceed the minimum by more than this are not delays: the board's time was paused."""
_JUMPS: Final = 3
_SILENCE_NS: Final = 30_000_000_000
"""Silence after which the estimate restarts, because the tick may have wrapped round."""


class BoardClock:
    """Maps the board's tick, ms modulo 65536, to `time.monotonic_ns()` of the host.

    Telemetry arrives with a varying delay; the smallest one of the last second gives the offset between the clocks.
    """

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Discard the estimate, because the board may have been reset or replaced."""
        self._tick: int | None = None
        self._board_ns = 0
        """Board time since the estimate began: the tick without wrap-around."""
        self._received_ns = 0
        self._least: deque[tuple[int, int]] = deque()
        """(board ns, offset ns), both ascending; the first is the minimum."""
        self._jumps = 0

    def feed(self, tick: int, received_ns: int) -> int:
        """Add the tick of a TELEMETRY and its arrival time; return the time of the tick, in monotonic ns.

        The result is never later than `received_ns`.
        """
        passed = 0 if self._tick is None else (tick - self._tick) % _WRAP
        if received_ns - self._received_ns > _SILENCE_NS or passed >= _WRAP // 2:
            self.restart()  # the tick went backwards: the board was reset
            passed = 0
        self._board_ns += passed * _MS
        self._tick, self._received_ns = tick, received_ns
        self._keep(self._board_ns, received_ns - self._board_ns)
        return min(self._board_ns + self._least[0][1], received_ns)

    def _keep(self, at: int, offset: int) -> None:
        """Add a sample, and keep only samples that may become the minimum when older ones leave the window."""
        late = bool(self._least) and offset - self._least[0][1] > _JUMP_NS
        self._jumps = self._jumps + 1 if late else 0
        if self._jumps == _JUMPS:
            self._least.clear()
        while self._least and offset <= self._least[-1][1]:
            self._least.pop()
        self._least.append((at, offset))
        while at - self._least[0][0] > _WINDOW_NS:
            self._least.popleft()
