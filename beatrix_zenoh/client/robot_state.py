"""A monitor's data of one robot: undecoded payloads, and the state, which is decoded when the user reads it."""

from __future__ import annotations

import time
from collections import Counter, deque
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Generic, TypeVar

import msgspec

from beatrix_zenoh.bus import Reply
from beatrix_zenoh.client.clocks import Offsets
from beatrix_zenoh.client.readings import Reading, reading
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Events, Positions, Reason, Status

LOST_S = 0.5
"""A robot without positions for this long (s) is lost, even with a token; positions arrive every 20 ms."""
RATE_S = 1.0
"""Time window (s) in which a rate is measured."""
STOP_SEATS = 64
"""Largest number of seats whose STOPs are counted for each robot."""

M = TypeVar("M", bound=msgspec.Struct)


class Presence(StrEnum):
    """Presence of a robot."""

    ON_LINE = "online"
    """The robot has a liveliness token, and positions arrive."""
    LOST = "lost"
    """The robot has a token, but no positions have arrived for 0.5 s: the node or its connection does not respond."""
    SILENT = "silent"
    """The robot has a token, but no positions have arrived yet."""
    ABSENT = "absent"
    """The robot has no token."""


@dataclass(frozen=True)
class RobotState:
    """State of one robot at one moment; ages in s (None: nothing has arrived yet)."""

    robot: str
    side: str
    presence: Presence
    status: Status | None
    status_age_s: float | None
    positions: Positions | None
    positions_age_s: float | None
    hz: float
    """positions per second over the last second"""
    events: tuple[Event, ...]
    """oldest first"""
    offsets: Offsets | None
    """clock offsets after `Monitor.measure_clocks`"""
    stops: tuple[tuple[str, int], ...] = ()
    """seats that have sent STOP to this robot, empty for an unknown one, and how often, the most frequent first"""

    @cached_property
    def reading(self) -> Reading | None:
        """The positions in degrees."""
        return None if self.positions is None else reading(self.positions)


class Channel(Generic[M]):
    """The newest publication of one key; Zenoh's thread stores it, a reader's thread decodes it at most once."""

    def __init__(self, client: Client, key: str, kind: type[M]) -> None:
        self._client, self._key, self._kind = client, key, kind
        self._newest: tuple[bytes, float] | None = None
        self._times: deque[float] = deque(maxlen=2 * keys.POSITIONS_HZ)
        self._decoded: tuple[bytes, M | None] | None = None

    def put(self, payload: bytes) -> None:
        """Store a publication that has just arrived."""
        now = time.monotonic()
        self._times.append(now)
        self._newest = payload, now

    @property
    def empty(self) -> bool:
        """Whether nothing has arrived yet."""
        return self._newest is None

    def read(self, now: float) -> tuple[M | None, float | None]:
        """Return the newest message (None: unreadable) and its age in s (None: nothing has arrived)."""
        if self._newest is None:
            return None, None
        payload, came = self._newest
        if self._decoded is None or self._decoded[0] is not payload:
            message = self._client.read(Reply(self._key, payload, "", error=False), self._kind)
            self._decoded = payload, message
        return self._decoded[1], max(0.0, now - came)

    def rate(self, now: float) -> float:
        """Return the publications per second over the last second."""
        recent = [moment for moment in self._times.copy() if now - moment < RATE_S]
        span = recent[-1] - recent[0] if len(recent) > 1 else 0.0
        return (len(recent) - 1) / span if span else 0.0


class EventLog:
    """The newest events of one robot, including those from before the subscription."""

    def __init__(self, client: Client, key: str, length: int) -> None:
        self._client, self._key, self._length = client, key, max(1, length)
        self._past = b""
        self._coming: deque[bytes] = deque(maxlen=self._length)
        self._read: list[Event] = []
        self._stops: Counter[str] = Counter()

    def put(self, payload: bytes) -> None:
        """Store an event that has just arrived."""
        self._coming.append(payload)

    def put_past(self, payload: bytes) -> None:
        """Store the robot's own list of its newest events."""
        self._past = payload

    def read(self) -> tuple[Event, ...]:
        """Decode the new events; return all stored events, oldest first."""
        past, self._past = self._past, b""
        known = {(event.t_mono_ns, event.seq) for event in self._read}
        found = list(self._read)
        if past:
            events = self._client.read(Reply(self._key, past, "", error=False), Events)
            found = [*([] if events is None else events.events), *found]
        while self._coming:
            event = self._client.read(Reply(self._key, self._coming.popleft(), "", error=False), Event)
            found += [] if event is None else [event]
        # Events published during the query arrive twice, and a restarted node counts from 0 again, so that time stamp
        # and number together identify an event.
        distinct = {(event.t_mono_ns, event.seq): event for event in found}
        for key, event in distinct.items():
            if event.kind is EventKind.STOP and event.reason is not Reason.MUTED and key not in known:
                self._count_stop(event)
        self._read = list(distinct.values())[-self._length :]
        return tuple(self._read)

    def _count_stop(self, event: Event) -> None:
        if event.seat in self._stops or len(self._stops) < STOP_SEATS:
            self._stops[event.seat] += event.count

    def stops(self) -> tuple[tuple[str, int], ...]:
        """Return how often each seat has sent STOP, in the events that were read, the most frequent first."""
        return tuple(self._stops.most_common())


class Record:
    """All stored data of one robot."""

    def __init__(self, client: Client, robot: str, side: str, events: int) -> None:
        self.robot, self.side = robot, side
        self.alive = False
        self.positions = Channel(client, keys.positions(robot, side), Positions)
        self.status = Channel(client, keys.status(robot, side), Status)
        self.events = EventLog(client, keys.events(robot, side), events)
        self.offsets: Offsets | None = None

    def state(self) -> RobotState:
        """Return the current state."""
        now = time.monotonic()
        positions, positions_age_s = self.positions.read(now)
        status, status_age_s = self.status.read(now)
        return RobotState(
            robot=self.robot,
            side=self.side,
            presence=self._presence(positions_age_s),
            status=status,
            status_age_s=status_age_s,
            positions=positions,
            positions_age_s=positions_age_s,
            hz=self.positions.rate(now),
            events=self.events.read(),
            offsets=self.offsets,
            stops=self.events.stops(),
        )

    def _presence(self, age_s: float | None) -> Presence:
        if not self.alive:
            return Presence.ABSENT
        if age_s is None:
            return Presence.SILENT
        return Presence.LOST if age_s > LOST_S else Presence.ON_LINE
