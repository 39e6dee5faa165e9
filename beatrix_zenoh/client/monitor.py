"""Live state of all robots and seats at a router: presence, status, positions, rates, ages, events."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Generic, NamedTuple, TypeVar

import msgspec

from beatrix_zenoh.bus import ProcessBound, Received, Reply
from beatrix_zenoh.client.degrees import Reading, reading
from beatrix_zenoh.client.request import matching_robot
from beatrix_zenoh.client.session import Client, Closable, Place
from beatrix_zenoh.client.subscription import Wakeup
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Events, Positions, Status
from beatrix_zenoh.contract.names import SIDES

LOST_S = 0.5
"""A robot without positions for this long (s) is lost, even with a token; positions arrive every 20 ms."""
RATE_S = 1.0
"""Time window (s) in which a rate is measured."""
SESSIONS = 1000
"""Largest number of sessions that are recorded; further ones, for example of a faulty program, are ignored."""
ASK_S = 1.0
"""Time limit (s) of the queries for the state that was published before the monitor began."""
ROBOTS = 1000
"""Largest number of robots; further names, for example of a faulty program, are ignored."""

M = TypeVar("M", bound=msgspec.Struct)
Sent = Received | Reply


class Presence(StrEnum):
    """Presence of a robot."""

    ONLINE = "online"
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

    @cached_property
    def reading(self) -> Reading | None:
        """The positions in degrees."""
        return None if self.positions is None else reading(self.positions)


class Channel(Generic[M]):
    """The newest publication of one key; Zenoh's thread stores it, a reader's thread decodes it at most once."""

    def __init__(self, client: Client, kind: type[M]) -> None:
        self._client, self._kind = client, kind
        self._newest: tuple[Sent, float] | None = None
        self._times: deque[float] = deque(maxlen=2 * keys.positions.rate_hz)
        self._decoded: tuple[Sent, M | None] | None = None

    def put(self, sent: Sent) -> None:
        """Store a publication that has just arrived."""
        now = time.monotonic()
        self._times.append(now)
        self._newest = sent, now

    @property
    def empty(self) -> bool:
        """Whether nothing has arrived yet."""
        return self._newest is None

    def read(self, now: float) -> tuple[M | None, float | None]:
        """Return the newest message (None: unreadable) and its age in s (None: nothing has arrived)."""
        if self._newest is None:
            return None, None
        sent, came = self._newest
        if self._decoded is None or self._decoded[0] is not sent:
            self._decoded = sent, self._client.read(sent, self._kind)
        return self._decoded[1], max(0.0, now - came)

    def rate(self, now: float) -> float:
        """Return the publications per second over the last second."""
        recent = [moment for moment in self._times.copy() if now - moment < RATE_S]
        span = recent[-1] - recent[0] if len(recent) > 1 else 0.0
        return (len(recent) - 1) / span if span else 0.0


class EventLog:
    """The newest events of one robot, including those from before the subscription."""

    def __init__(self, client: Client, length: int) -> None:
        self._client, self._length = client, max(1, length)
        self._past: Reply | None = None
        self._coming: deque[Sent] = deque(maxlen=self._length)
        self._read: list[Event] = []

    def put(self, sent: Sent) -> None:
        """Store an event that has just arrived."""
        self._coming.append(sent)

    def put_past(self, answer: Reply) -> None:
        """Store the robot's own list of its newest events."""
        self._past = answer

    def read(self) -> tuple[Event, ...]:
        """Decode the new events; return all stored events, oldest first."""
        past, self._past = self._past, None
        events = None if past is None else self._client.read(past, Events)
        found = [*([] if events is None else events.events), *self._read]
        while self._coming:
            event = self._client.read(self._coming.popleft(), Event)
            found += [] if event is None else [event]
        # Events published during the query arrive twice, and a restarted node counts from 0 again, so that time stamp
        # and number together identify an event.
        distinct = {(event.t_mono_ns, event.seq): event for event in found}
        self._read = list(distinct.values())[-self._length :]
        return tuple(self._read)


class RobotRecord:
    """All stored data of one robot."""

    def __init__(self, client: Client, robot: str, side: str, events: int) -> None:
        self.robot, self.side = robot, side
        self.alive = False
        self.changes = 0
        """number of tokens, statuses and events that have arrived"""
        self.positions = Channel(client, Positions)
        self.status = Channel(client, Status)
        self.events = EventLog(client, events)
        self.channels: dict[str, Channel[Positions] | Channel[Status] | EventLog] = {
            "positions": self.positions,
            "status": self.status,
            "events": self.events,
        }
        """What stores the publications of each row of keys.toml."""

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
        )

    def _presence(self, age_s: float | None) -> Presence:
        if not self.alive:
            return Presence.ABSENT
        if age_s is None:
            return Presence.SILENT
        return Presence.LOST if age_s > LOST_S else Presence.ONLINE


class Monitor(ProcessBound, Closable):
    """All robots of a router, live; read their states with `robots` and `robot`.

        with Robot("bea1") as robot, Monitor(robot.client) as monitor:
            monitor.settle()  # until the first status of each robot has arrived
            print([state.robot for state in monitor.robots()])

    Zenoh's thread only stores payloads. They are decoded when a state is read, of positions and status only the
    newest ones, so that 30 robots with 50 positions a second cost little. Undecodable payloads are skipped and logged
    once. Only one thread may read.
    """

    def __init__(self, client: Client, robot: str = "*", side: str = "*", *, events: int = 0) -> None:
        """Query the robots online and begin to monitor.

        Args:
            client: the session.
            robot: name of one robot, or `*`.
            side: `sim`, `hw` or `*`.
            events: number of events to keep for each robot, including up to 200 earlier ones; 0: do not subscribe.

        Raises:
            NoAnswer: ACCOUNT_REFUSED, as `Client.robots`.
            WrongUsage: the client was closed.
        """
        self._client, self._events = client, events
        self._wakeup = Wakeup()
        self._adding = threading.Lock()
        self._changes = self._seen = 0
        self._records: dict[Place, RobotRecord] = {}
        bus = client.bus
        # This query must precede the subscription to tokens: just after it, Zenoh would return an empty list.
        for place in client.robots():
            if robot in ("*", place[0]) and side in ("*", place[1]):
                self._on_token(keys.alive(*place), alive=True)
        self._undeclare = [
            bus.subscribe(keys.positions(robot, side), self._on_positions),
            bus.subscribe(keys.status(robot, side), self._on_change),
            bus.watch_tokens(keys.alive(robot, side), self._on_token),
        ]
        past = [keys.status(robot, side)]
        if events:
            self._undeclare.append(bus.subscribe(keys.events(robot, side), self._on_change))
            past.append(keys.events(robot, side))
        for key in past:
            query = bus.query(key, None, codec.MSGPACK, timeout_s=ASK_S)
            query.hand_over(lambda answer, key=key: self._on_answer(key, answer))  # type: ignore[misc]
            self._undeclare.append(query.close)
        client.at_close(self)

    # -- Zenoh's thread: store, nothing else --------------------------------------------------------

    def _on_positions(self, received: Received) -> None:
        parts = keys.parse(received.key)
        record = None if parts is None or "*" in received.key else self._record((parts.robot, parts.side))
        if parts is not None and record is not None:
            record.channels[parts.row].put(received)
            record.changes += record.channels[parts.row] is not record.positions

    def _on_change(self, received: Received) -> None:
        self._on_positions(received)
        self._changed()

    def _on_answer(self, asked: str, answer: Reply) -> None:
        place = None if answer.error else matching_robot(asked, answer.key)
        record = None if place is None else self._record(place)
        if record is None:
            return
        if answer.key == keys.events(record.robot, record.side):
            record.events.put_past(answer)
        elif record.status.empty:  # a later publication is newer
            record.status.put(answer)
        self._changed()

    def _on_token(self, key: str, alive: bool) -> None:  # noqa: FBT001
        parts = keys.parse(key)
        record = None if parts is None else self._record((parts.robot, parts.side))
        if record is not None:
            record.alive = alive
            record.changes += 1
            self._changed()

    def _record(self, place: Place) -> RobotRecord | None:
        with self._adding:
            if place not in self._records and len(self._records) < ROBOTS:
                self._records[place] = RobotRecord(self._client, *place, self._events)
            return self._records.get(place)

    def _changed(self) -> None:
        self._changes += 1
        self._wakeup.set()

    # -- the reader's thread ------------------------------------------------------------------------

    def wait(self, timeout_s: float) -> bool:
        """Wait for a status, an event or a change of presence since the last call; return False after `timeout_s`.

        Positions do not end the wait.
        """
        changed = self._wakeup.wait_for(lambda: self._changes != self._seen, timeout_s)
        self._seen = self._changes
        return changed

    def settle(self, timeout_s: float = ASK_S) -> None:
        """Wait until the status of every robot online has arrived, at most `timeout_s` (s)."""
        self._wakeup.wait_for(self._settled, timeout_s)

    def _settled(self) -> bool:
        return not any(record.alive and record.status.empty for record in list(self._records.values()))

    def robots(self) -> list[RobotState]:
        """Return the states of all robots that have been online since the monitor began, by name, simulation first."""
        places = sorted(self._records, key=lambda place: (place[0], place[1] != "sim"))
        return [self.robot(*place) for place in places]

    def present(self) -> list[Place]:
        """Return name and side of all robots with a liveliness token, unordered; any thread may call this."""
        return [place for place, record in list(self._records.items()) if record.alive]

    def changes(self, name: str) -> int:
        """Return a number that grows with each token, status and event of the robots of this name; any thread may call this."""
        records = (self._records.get((name, side)) for side in SIDES)
        return sum(record.changes for record in records if record is not None)

    def robot(self, name: str, side: str) -> RobotState:
        """Return the state of one robot; its presence is ABSENT if nothing has arrived from it."""
        record = self._records.get((name, side))
        return (RobotRecord(self._client, name, side, 0) if record is None else record).state()

    def positions(self, name: str, side: str) -> Positions | None:
        """Return the newest positions of one robot, without the cost of its whole state; None: none are known."""
        record = self._records.get((name, side))
        return None if record is None else record.positions.read(time.monotonic())[0]

    def close(self) -> None:
        """End the subscriptions. May be called twice."""
        while self._undeclare:
            self._undeclare.pop()()


class Seats:
    """The connected seats, live until the client is closed; any thread may read them."""

    def __init__(self, client: Client) -> None:
        self._sessions: dict[str, str] = {}
        client.bus.watch_tokens(keys.seat("*", "*"), self._on_token)

    def _on_token(self, key: str, alive: bool) -> None:  # noqa: FBT001
        """Record on Zenoh's thread that a session of a seat has begun or ended."""
        parts = keys.parse(key)
        if parts is not None and alive:
            if len(self._sessions) < SESSIONS:
                self._sessions[parts.session] = parts.who
        elif parts is not None:
            self._sessions.pop(parts.session, None)

    def names(self) -> list[str]:
        """Return each seat once, sorted."""
        return sorted({*self._sessions.copy().values()})


class SeatStops(NamedTuple):
    """The STOPs of one seat."""

    seat: str
    """empty: unknown"""
    total: int
    robots: dict[Place, int]
    """STOPs of each robot. Its own status reports them, so those of a student's simulation prove nothing."""


def stops_by_seat(robots: Iterable[RobotState]) -> list[SeatStops]:
    """Return the STOPs of all seats since the nodes of these robots started, the most frequent seat first."""
    found: dict[str, dict[Place, int]] = {}
    for robot in robots:
        for one in () if robot.status is None else robot.status.stops:
            found.setdefault(one.seat, {})[robot.robot, robot.side] = one.count
    stops = [SeatStops(seat, sum(counts.values()), counts) for seat, counts in found.items()]
    return sorted(stops, key=lambda one: (-one.total, one.seat))
