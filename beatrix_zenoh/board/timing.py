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
"""Age up to which a minimum is used. In this time a drift of 1000 ppm shifts it by 1 ms, which `_slope` corrects."""
_JUMP_NS: Final = 60_000_000
"""_JUMPS offsets in a row that exceed the minimum by more than this are not delays: the board's time was paused."""
_JUMPS: Final = 3
_SILENCE_NS: Final = 30_000_000_000
"""Silence after which the estimate restarts, because the tick may have wrapped round."""
_SLOPE_WINDOWS: Final = 20
_SLOPE_MAX: Final = 0.003


class BoardClock:
    """Maps the board's tick, ms modulo 65536, to `time.monotonic_ns()` of the host.

    Telemetry arrives with a varying delay. The smallest delay of the last second therefore gives the offset between the
    clocks; the change of that minimum from second to second gives their drift.
    """

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Discard the estimate, because the board may have been reset or replaced."""
        self._tick: int | None = None
        self._board_ns = 0
        """Board time since the estimate began: the tick without wrap-around."""
        self._received_ns = 0
        self._slope = 0.0
        """Growth of the offset, ns per ns of board time."""
        self._least: deque[tuple[int, int]] = deque()
        """(board ns, offset ns): times ascending, slope-corrected offsets ascending; the first is the minimum."""
        self._minima: deque[tuple[int, int]] = deque(maxlen=_SLOPE_WINDOWS)
        self._window: tuple[int, int] | None = None
        self._window_end_ns = _WINDOW_NS
        self._late: list[tuple[int, int]] = []

    def feed(self, tick: int, received_ns: int) -> int:
        """Add the tick of a TELEMETRY and its arrival time; return the time of the tick, in monotonic ns.

        The result is never later than `received_ns`.
        """
        if self._tick is None or received_ns - self._received_ns > _SILENCE_NS:
            self.restart()
        elif (tick - self._tick) % _WRAP >= _WRAP // 2:
            self.restart()  # the tick went backwards: the board was reset
        else:
            self._board_ns += (tick - self._tick) % _WRAP * _MS
        self._tick, self._received_ns = tick, received_ns
        self._add(self._board_ns, received_ns - self._board_ns)
        at, offset = self._least[0]
        moment_ns = self._board_ns + offset + round(self._slope * (self._board_ns - at))
        return min(moment_ns, received_ns)

    def _add(self, at: int, offset: int) -> None:
        if self._least:
            first_at, first = self._least[0]
            if offset - first - self._slope * (at - first_at) > _JUMP_NS:
                self._late.append((at, offset))
                if len(self._late) < _JUMPS:
                    return
                self._least.clear()
                self._minima.clear()
                self._window = None
                self._window_end_ns = at + _WINDOW_NS
                late, self._late = self._late, []
                for sample in late:
                    self._keep(*sample)
                return
        self._late.clear()
        self._keep(at, offset)
        self._follow_drift(at, offset)

    def _keep(self, at: int, offset: int) -> None:
        """Add a sample, and keep only samples that may become the minimum when older ones leave the window."""
        while self._least and offset <= self._least[-1][1] + self._slope * (at - self._least[-1][0]):
            self._least.pop()
        self._least.append((at, offset))
        while at - self._least[0][0] > _WINDOW_NS:
            self._least.popleft()

    def _follow_drift(self, at: int, offset: int) -> None:
        if at >= self._window_end_ns:
            if self._window is not None:
                self._minima.append(self._window)
                self._fit()
            self._window, self._window_end_ns = None, at + _WINDOW_NS
        if self._window is None or offset < self._window[1] + self._slope * (at - self._window[0]):
            self._window = at, offset

    def _fit(self) -> None:
        """Set the slope by a least-squares line through the minima of the last windows."""
        if len(self._minima) < 3:
            return
        begin, base = self._minima[0]
        xs = [at - begin for at, _ in self._minima]
        ys = [offset - base for _, offset in self._minima]
        mean_x, mean_y = sum(xs) / len(xs), sum(ys) / len(ys)
        spread = sum((x - mean_x) ** 2 for x in xs)
        slope = sum((x - mean_x) * (y - mean_y) for x, y in zip(xs, ys, strict=True)) / spread
        self._slope = max(-_SLOPE_MAX, min(_SLOPE_MAX, slope))
