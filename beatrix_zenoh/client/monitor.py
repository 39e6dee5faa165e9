"""Live state of all robots and seats at a router: presence, status, positions, rates, ages, events."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import NamedTuple, Self

from beatrix_zenoh.bus import ProcessBound, Received, Reply
from beatrix_zenoh.client.clocks import Offsets, clock_offsets
from beatrix_zenoh.client.request import own_place
from beatrix_zenoh.client.robot_state import Record, RobotState
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.subscription import Wakeup
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys

SESSIONS = 1000
"""Largest number of sessions that are recorded; further ones, for example of a faulty program, are ignored."""

ASK_S = 1.0
"""Time limit (s) of the queries for the state that was published before the monitor began."""
ROBOTS = 1000
"""Largest number of robots; further names, for example of a faulty program, are ignored."""


class Monitor(ProcessBound):
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
        self._records: dict[Place, Record] = {}
        self._puts: dict[str, Callable[[bytes], None]] = {}
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
        self._forget = client.at_close(self.close)

    # -- Zenoh's thread: store, nothing else --------------------------------------------------------

    def _on_positions(self, received: Received) -> None:
        put = self._puts.get(received.key) or self._put_of(received.key)
        if put is not None:
            put(received.payload)

    def _on_change(self, received: Received) -> None:
        self._on_positions(received)
        self._changed()

    def _on_answer(self, asked: str, answer: Reply) -> None:
        place = None if answer.error else own_place(asked, answer.key)
        record = None if place is None else self._record(place)
        if record is None:
            return
        if answer.key == keys.events(record.robot, record.side):
            record.events.put_past(answer.payload)
        elif record.status.empty:  # a later publication is newer
            record.status.put(answer.payload)
        self._changed()

    def _on_token(self, key: str, alive: bool) -> None:  # noqa: FBT001
        parts = keys.parse(key)
        record = None if parts is None else self._record((parts.robot, parts.side))
        if record is not None:
            record.alive = alive
            self._changed()

    def _put_of(self, key: str) -> Callable[[bytes], None] | None:
        """Return the function that stores publications of a key; None if the monitor does not store them."""
        parts = keys.parse(key)
        record = None if parts is None or "*" in key else self._record((parts.robot, parts.side))
        if record is None:
            return None
        puts = {
            keys.positions(record.robot, record.side): record.positions.put,
            keys.status(record.robot, record.side): record.status.put,
            keys.events(record.robot, record.side): record.events.put,
        }
        self._puts |= puts
        return puts.get(key)

    def _record(self, place: Place) -> Record | None:
        with self._adding:
            if place not in self._records and len(self._records) < ROBOTS:
                self._records[place] = Record(self._client, *place, self._events)
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

    def robot(self, name: str, side: str) -> RobotState:
        """Return the state of one robot; its presence is ABSENT if nothing has arrived from it."""
        record = self._records.get((name, side))
        return (Record(self._client, name, side, 0) if record is None else record).state()

    def measure_clocks(self, name: str, side: str) -> Offsets:
        """Measure the offsets of a robot's clocks and add them to its states; raises the errors of `clock_offsets`."""
        offsets = clock_offsets(self._client, name, side)
        record = self._record((name, side))
        if record is not None:
            record.offsets = offsets
        return offsets

    def close(self) -> None:
        """End the subscriptions. May be called twice."""
        self._forget()
        while self._undeclare:
            self._undeclare.pop()()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


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
    """STOPs of each robot. Its own events report them, so those of a student's simulation prove nothing."""


def stops_by_seat(robots: Iterable[RobotState]) -> list[SeatStops]:
    """Return the STOPs of all seats in the events of these robots, the most frequent seat first."""
    found: dict[str, dict[Place, int]] = {}
    for robot in robots:
        for seat, count in robot.stops:
            found.setdefault(seat, {})[robot.robot, robot.side] = count
    stops = [SeatStops(seat, sum(counts.values()), counts) for seat, counts in found.items()]
    return sorted(stops, key=lambda one: (-one.total, one.seat))
