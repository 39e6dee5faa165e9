"""Gives each publication its time by the clock of the recording computer."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Final, NamedTuple

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.subscription import Arrival
from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.recording.losses import Losses, seq_of, stream_of
from beatrix_zenoh.recording.robot_queries import RobotAnswer, RobotQueries
from beatrix_zenoh.recording.subscriptions import Value
from beatrix_zenoh.recording.timebase import Delay, Timebase

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
