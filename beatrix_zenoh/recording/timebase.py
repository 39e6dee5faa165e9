"""Gives each publication its time by the clock of the recording computer."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from enum import Enum, auto
from typing import Final, NamedTuple

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.recording.losses import Losses, seq_of, stream_of
from beatrix_zenoh.recording.sources import RobotAnswer, RobotQueries, Value

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


WAITING: Final = 500
"""Publications of a robot that are kept until its clock offset is known; if more arrive, the oldest are
dropped and counted."""
UNKNOWN_NS: Final = 1_000_000_000
"""Assumed error of a clock offset that was estimated from arrival times."""
CHECKED_NS: Final = 5_000_000_000
"""Time for which a measured clock offset is trusted although times do not fit to it."""


class Timed(NamedTuple):
    """A publication, and the time of its values by the clock of the recording computer, since 1970."""

    arrival: Arrival[Value]
    time_ns: int
    stale: bool = False
    """whether positions repeat others of long ago, because the node gets no telemetry"""


class TimedArrivals:
    """Keeps publications until the clock offset of their robot is known, and measures it again if times do not fit.

    Counts all publications, and those that are dropped, left out or late.
    """

    def __init__(self, timebase: Timebase, queries: RobotQueries, losses: Losses) -> None:
        self._timebase, self._queries, self._losses = timebase, queries, losses
        self._waiting: dict[Place, deque[Arrival[Value]]] = {}
        self._checked_ns: dict[Place, int] = {}

    def arrived(self, arrival: Arrival[Value]) -> Iterator[Timed]:
        """Yield the publication with its time, or keep it while the clock offset is unknown."""
        place = arrival.robot, arrival.side
        self._losses.received(stream_of(place, arrival.value), seq_of(arrival.value))
        if self._is_wrong(place, arrival):
            # The robot's computer was restarted or slept, or the publication is late: the answer shows which.
            self._checked_ns[place] = arrival.t_mono_ns
            self._timebase.forget(place)
        if self._timebase.knows(place):
            yield from self._timed(place, arrival)
            return
        if place not in self._waiting:
            self._waiting[place] = deque()
            self._queries.request(place)
        waiting = self._waiting[place]
        if len(waiting) == WAITING:
            self._losses.overflowed(stream_of(place, waiting.popleft().value))
        waiting.append(arrival)

    def answered(self, answer: RobotAnswer) -> Iterator[Timed]:
        """Use the answer of a robot; yield the publications that were kept until then."""
        place, waiting = answer.place, self._waiting.pop(answer.place, ())
        if answer.offset is not None:
            self._timebase.learn(place, answer.offset.offset_ns, answer.offset.bound_ns)
        elif waiting:
            # The robot publishes without answering: the fastest publication gives the best estimate.
            offset_ns = max(arrival.value.t_mono_ns - arrival.t_mono_ns for arrival in waiting)
            self._timebase.learn(place, offset_ns, UNKNOWN_NS)
        for arrival in waiting:
            yield from self._timed(place, arrival)

    def _is_wrong(self, place: Place, arrival: Arrival[Value]) -> bool:
        """Return whether positions make a new measurement of the clock offset necessary."""
        value = arrival.value
        return (
            isinstance(value, Positions)
            and not value.repeated
            and self._timebase.knows(place)
            and self._timebase.delay(place, value.t_mono_ns, arrival.t_mono_ns) is not Delay.NONE
            and arrival.t_mono_ns >= self._checked_ns.get(place, -CHECKED_NS) + CHECKED_NS
        )

    def _timed(self, place: Place, arrival: Arrival[Value]) -> Iterator[Timed]:
        """Yield a publication with its time, unless its time stamps are impossible: it would spoil the recording."""
        value = arrival.value
        stream = stream_of(place, value)
        delay = self._timebase.delay(place, value.t_mono_ns, arrival.t_mono_ns)
        if isinstance(value, Positions) and value.repeated and delay is not Delay.NONE:
            yield Timed(arrival, self._timebase.time_ns(place, value.t_mono_ns), stale=True)
            return
        if delay is Delay.IMPOSSIBLE or value.t_wall_ns < 0:
            self._losses.impossible(stream)
            return
        if delay is Delay.LATE:
            self._losses.late(stream)
        yield Timed(arrival, self._timebase.time_ns(place, value.t_mono_ns))
