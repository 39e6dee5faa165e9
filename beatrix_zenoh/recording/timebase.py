"""Converts times of robots' monotonic clocks to the wall clock of the recording computer."""

from __future__ import annotations

from enum import Enum, auto
from typing import Final

from beatrix_zenoh.client.session import Place

LATE_NS: Final = 2_000_000_000
"""A publication that arrives so long after its time (ns) is late, or the clock of the robot has jumped."""
LATEST_NS: Final = 120_000_000_000
"""The queues of network and recorder hold publications for at most about this time (ns)."""


class Delay(Enum):
    """How the time of a publication relates to its arrival."""

    NONE = auto()
    """less than 2 s before or after it"""
    LATE = auto()
    """the publication was under way for more than 2 s, for example because a computer was busy"""
    IMPOSSIBLE = auto()
    """the time is in the future, or older than any queue can make it"""


class Timebase:
    """Times of samples by the recording computer's clock.

    Both sides use monotonic clocks, so that changes of a wall clock during the recording have no effect. Queries
    measure the offset between them (client.clocks); the wall clock of the recording computer is read once, at the
    beginning.
    """

    def __init__(self, mono_ns: int, wall_ns: int) -> None:
        """Start with the times of both clocks of the recording computer at one moment."""
        self._anchor_ns = wall_ns - mono_ns
        self._offsets: dict[Place, tuple[int, int]] = {}

    def learn(self, place: Place, offset_ns: int, bound_ns: int) -> None:
        """Add a measured offset, robot's clock minus ours; an earlier one that agrees and is more exact is kept.

        Clocks drift apart, so a kept offset gets twice its error bound with each new measurement.
        """
        before = self._offsets.get(place)
        if before is not None and before[1] * 2 < bound_ns and abs(before[0] - offset_ns) <= bound_ns:
            self._offsets[place] = before[0], before[1] * 2
        else:
            self._offsets[place] = offset_ns, bound_ns

    def forget(self, place: Place) -> None:
        """Drop an offset that is no longer valid."""
        self._offsets.pop(place, None)

    def knows(self, place: Place) -> bool:
        """Return whether the robot's offset is known."""
        return place in self._offsets

    def time_ns(self, place: Place, mono_ns: int) -> int:
        """Convert a time of the robot's monotonic clock to our wall clock; its offset must be known."""
        return mono_ns - self._offsets[place][0] + self._anchor_ns

    def own_ns(self, mono_ns: int) -> int:
        """Convert a time of our monotonic clock to our wall clock."""
        return mono_ns + self._anchor_ns

    def delay(self, place: Place, mono_ns: int, arrived_ns: int) -> Delay:
        """Return how the time of a publication relates to its arrival (our monotonic clock); the offset must be known."""
        delay_ns = arrived_ns - (mono_ns - self._offsets[place][0])
        if -LATE_NS < delay_ns < LATE_NS:
            return Delay.NONE
        return Delay.LATE if LATE_NS <= delay_ns <= LATEST_NS else Delay.IMPOSSIBLE
