"""The frame rate of the simulated cameras: the requested one, unless physics needs the time."""

from __future__ import annotations

from typing import Final

SHARE: Final = 0.5
"""Largest share of the time for drawing; on two cores the rest is for physics and all other threads."""
SLOWEST_S: Final = 2.0
"""Longest time between two pictures, also on a busy computer."""
SLOWER: Final = 1.5
"""Factor for the period after a picture during which physics steps were late."""
FASTER: Final = 0.97
"""Factor for the period after a picture during which no physics step was late."""
MEMORY: Final = 0.8
"""Weight of the past in the mean time that a picture takes."""


class FrameRate:
    """Computes when to draw next; all times in seconds of one monotonic clock."""

    def __init__(self, requested_hz: float) -> None:
        self._requested_s = 1.0 / requested_hz
        self._due_s = float("-inf")
        self._cost_s = 0.0
        self._held_back = 1.0

    @property
    def period_s(self) -> float:
        """The present time between two pictures."""
        wanted = max(self._requested_s, self._cost_s / SHARE) * self._held_back
        return max(self._requested_s, min(wanted, SLOWEST_S))

    @property
    def slowed(self) -> bool:
        """Whether the rate is below the requested one."""
        return self.period_s > self._requested_s

    def wait_s(self, now_s: float) -> float:
        """Return the seconds until the next picture is due."""
        return max(0.0, self._due_s - now_s)

    def drawn(self, begin_s: float, end_s: float, *, late: bool) -> None:
        """Record how long a picture of each camera took to draw, and schedule the next.

        `late`: whether physics steps were late meanwhile.
        """
        cost_s = end_s - begin_s
        self._cost_s = MEMORY * self._cost_s + (1 - MEMORY) * cost_s if self._cost_s else cost_s
        self._held_back = self._held_back * SLOWER if late else max(1.0, self._held_back * FASTER)
        self._held_back = min(self._held_back, SLOWEST_S / self._requested_s)
        # Count from the deadline, so that the mean rate is the requested one. Missed pictures are not drawn later.
        missed = self._due_s + self.period_s < begin_s
        self._due_s = (begin_s if missed else self._due_s) + self.period_s

    def reset(self) -> None:
        """Reset after the last subscriber has gone: the next picture is due at once."""
        self._due_s, self._cost_s, self._held_back = float("-inf"), 0.0, 1.0
