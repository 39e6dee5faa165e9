"""The state for clients: positions at 50 Hz, status on change and once a second, events within 20 ms; state queries.

Queries for keys that the robot does not have get an error reply.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, lru_cache

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Incoming, Publication, Sessions
from beatrix_zenoh.contract import codec, refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Detail,
    ErrorReply,
    EventKind,
    Fault,
    Reason,
    Status,
)
from beatrix_zenoh.contract.errors import quoted
from beatrix_zenoh.contract.rows import KeyRow
from beatrix_zenoh.contract.values import rows
from beatrix_zenoh.node.events import NodeEvents, new_event
from beatrix_zenoh.node.interfaces import Component
from beatrix_zenoh.node.snapshot import Snapshot
from beatrix_zenoh.schedule import SLACK_S, Schedule, ScheduledTask
from beatrix_zenoh.threads import Owner


class StatusEvents:
    """Compares each status with the previous one, and records changes as events."""

    def __init__(self, events: NodeEvents) -> None:
        self._events = events
        self._holder = ""
        self._trouble = ""

    def record(self, status: Status) -> None:
        """Record another holder, and a lost or connected board, as events."""
        if status.holder != self._holder:
            text = f"{status.holder} drives." if status.holder else f"{self._holder} has freed the robot."
            self._events.add(new_event(kind=EventKind.LEASE, seat=status.holder, message=text))
        trouble = board_trouble(status)
        if trouble != self._trouble:
            reason = Reason.BOARD_LOST if trouble else Reason.OK
            text = trouble or f"The board at {status.board.port} is connected."
            self._events.add(new_event(kind=EventKind.BOARD, reason=reason, message=text))
        self._holder, self._trouble = status.holder, trouble


def board_trouble(status: Status) -> str:
    """Return why the board is not connected, as a sentence; empty if it is connected."""
    lost = not status.board.connected or status.fault in (Fault.BOARD_LOST, Fault.CONTRACT_MISMATCH)
    return status.warnings[0] if lost and status.warnings else ""


PERIOD_S = 1 / keys.positions.rate_hz
STATUS_S = 1 / keys.status.rate_hz
CHECK_S = 0.2
"""Longest time (s) between two comparisons of the status with the last one: a camera that comes or goes, a reassembled
neck. After each change of the board's state and each request the controller calls `changed`: it takes more time to
assemble a status than to publish positions."""

SHIFT_S = 0.0002
"""Largest change (s) of one period of the publications."""
AFTER_S = SLACK_S / 2
"""Time (s) of a publication after the turn of a virtual board on the same thread, which then wakes once for both."""


def phase_shift(due_s: float, sample_s: float, sampling_s: float) -> float:
    """Return the shift (s) of the publications that brings them to the middle between two samples.

    A publication that is due just when a sample is made contains, by chance, this one or the one before it. The period
    of the time stamps then varies by a whole `sampling_s`. `sample_s`: time of any sample.
    """
    return _shift((due_s - sample_s) % sampling_s - sampling_s / 2, sampling_s / 8)


def turn_shift(due_s: float, sample_s: float) -> float:
    """Return the shift (s) of the publications that brings them just after the turns of the board on the same thread.

    `sample_s`: time of the sample that the last turn has made.
    """
    return _shift((due_s - sample_s - AFTER_S + PERIOD_S / 2) % PERIOD_S - PERIOD_S / 2, AFTER_S / 2)


def _shift(off_s: float, tolerated_s: float) -> float:
    return 0.0 if abs(off_s) < tolerated_s else -math.copysign(min(abs(off_s), SHIFT_S), off_s)


class StatePublication:
    """Publications of one kind of message in msgpack and as JSON text, each while a client subscribes to its key."""

    def __init__(self, sessions: Sessions, key: str, json_key: str, changed: Callable[[], None]) -> None:
        """Declare the publications; `changed` is called when `subscribed` may have changed, also by Zenoh's thread."""
        self._packed: Publication = sessions.publication(key, codec.MSGPACK, changed)
        self._json: Publication = sessions.publication(json_key, codec.JSON, changed)

    @property
    def subscribed(self) -> bool:
        """Whether a client subscribes to one of the two keys."""
        return self._packed.subscribed or self._json.subscribed

    def put(self, message: msgspec.Struct) -> None:
        """Publish a message; Zenoh drops it for a subscriber that cannot keep up."""
        if self._packed.subscribed:
            self._packed.put(codec.encode(message))
        if self._json.subscribed:
            self._json.put(codec.encode_json(message))


class Publisher(Component):
    """Publishes positions, status and events until closed.

    It has a turn at the rate of positions while a client subscribes to anything, otherwise every CHECK_S and when `changed` is
    called.
    """

    def __init__(
        self,
        snapshot: Snapshot,
        events: NodeEvents,
        owner: Owner,
        schedule: Schedule,
    ) -> None:
        """Store the arguments; `start` declares the publications.

        Args:
            snapshot: builds the messages.
            events: the events to publish.
            owner: the robot.
            schedule: thread that publishes. If it advances the board of the robot, too, each publication follows a turn
                of the board.
        """
        self._snapshot, self._recorded = snapshot, events
        self._changes = StatusEvents(events)
        self._published: object = None
        self._status_due_s = self._check_due_s = 0.0
        self._dirty, self._idle = True, False
        self._due_s = float("inf")
        self._owner, self._schedule, self._in_step = owner, schedule, False
        self._task: ScheduledTask | None = None

    def start(self, sessions: Sessions) -> None:
        def publication(key: KeyRow, json_key: KeyRow) -> StatePublication:
            name, side = self._snapshot.name, self._snapshot.side
            return StatePublication(sessions, key(name, side), json_key(name, side), self.changed)

        self._positions = publication(keys.positions, keys.positions_json)
        self._status = publication(keys.status, keys.status_json)
        self._events = publication(keys.events, keys.events_json)
        self._in_step = self._schedule.serves(self._owner)
        self._task = self._schedule.add(self._owner, self._turn)
        self._due_s = time.monotonic()
        self._task.wake()

    def changed(self) -> None:
        """Compare the status within a period; any thread may call this."""
        self._dirty = True
        if self._idle and self._task is not None:
            (self._task.soon if self._in_step else self._task.wake)()

    def _turn(self) -> float:
        """Publish what is due; return the monotonic time (s) of the next turn."""
        watched = self._positions.subscribed
        if watched:
            positions = self._snapshot.positions(count=True)
            self._positions.put(positions)
            if not positions.repeated:
                self._due_s += self._phase_shift(positions.t_mono_ns / 1e9)
        self._publish_changes()
        self._idle = not (watched or self._status.subscribed or self._events.subscribed)
        if self._idle and self._dirty and self._task is not None:
            self.changed()  # it was called before the thread was idle
        period_s, now_s = CHECK_S if self._idle else PERIOD_S, time.monotonic()
        # After a stall of the process, skip the missed publications: clients need no burst of old positions. After a
        # wake-up the periods begin anew.
        early = self._due_s > now_s + SLACK_S
        self._due_s = now_s + period_s if early else max(self._due_s + period_s, now_s - period_s)
        return self._due_s

    def _phase_shift(self, sample_s: float) -> float:
        if self._in_step:
            return turn_shift(self._due_s, sample_s)
        return phase_shift(self._due_s, sample_s, self._snapshot.sampling_s)

    def _publish_changes(self) -> None:
        now_s = time.monotonic()
        if self._dirty or now_s >= self._check_due_s:
            self._dirty, self._check_due_s = False, now_s + CHECK_S
            self._publish_status()
        self._publish_events()

    def _publish_status(self, *, always: bool = False) -> None:
        status = self._snapshot.status()
        values = change_fields(status)
        now_s = time.monotonic()
        if values != self._published:
            self._changes.record(status)
        if always or values != self._published or now_s >= self._status_due_s:
            self._published, self._status_due_s = values, now_s + STATUS_S
            self._status.put(status)

    def _publish_events(self) -> None:
        for event in self._recorded.take():
            self._events.put(event)

    def close(self) -> None:
        """Publish a last status and the last events."""
        if self._task is not None and self._schedule.remove(self._task):
            self._publish_status(always=True)
            self._publish_events()


@cache
def _changing(kind: type[msgspec.Struct]) -> list[str]:
    """Return the fields whose change is published at once; clocks and rates, which always change, are left out."""
    return [name for name, row in rows(kind).items() if row.on_change]


def change_fields(value: object) -> object:
    """Return the fields of a status, and of its parts, whose change is published at once."""
    if isinstance(value, list):
        return [change_fields(one) for one in value]
    if isinstance(value, msgspec.Struct):
        return [change_fields(getattr(value, name)) for name in _changing(type(value))]
    return value


CACHED_KEYS = 256


class UnknownKeys:
    """Decides which keys below `beatrix/<robot>/<side>/` the robot does not have; any thread may call its methods."""

    def __init__(self, robot: str, side: str) -> None:
        self.base = f"beatrix/{robot}/{side}/"
        fields = dict.fromkeys(("who", "arm", "eye", "session", "lesson", "gesture"), "*")
        rows = [row for row in keys.KEYS.values() if side in row.sides]
        found = {row.key.format_map({**fields, "robot": robot, "side": side}): row.kind for row in rows}
        self._known = {key: kind for key, kind in found.items() if key.startswith(self.base)}
        self.has = lru_cache(CACHED_KEYS)(self._has)
        """Returns whether a key is one of the robot's, or has a wildcard; only other keys get the error reply."""

    def _has(self, key: str) -> bool:
        return "*" in key or any(zbus.intersects(known, key) for known in self._known)

    def error(self, key: str) -> ErrorReply:
        """Return the error reply to a query for a key that the robot does not have."""
        refusal = refusals.bad_field(
            key,
            f"This robot has no key {quoted(key)}. {self.base}info lists all.",
            [known.replace("*", "<who>") for known, kind in self._known.items() if "query" in kind],
        )
        detail = refusal.detail or Detail()
        return ErrorReply(result=False, reason=refusal.reason, message=refusal.message, detail=detail)


REST = {"control": ("*", "*/*", "*/*/*/*", "*/*/*/*/*", "*/*/*/*/*/*"), "motion": ("*/*/*",)}
"""Key expressions below the robot's own that receive the queries for unknown keys, by traffic class. They also receive
the queries for known keys, so STOP and motions must find them in their own session: another would cost 0.15 ms. The
routers of a class accept no declaration with `**` from a seat."""


Answer = Callable[[Incoming], msgspec.Struct]
"""Returns the reply to a query."""


class QueryThread(Component):
    """Answers the queries of some keys, one after the other; Zenoh's threads only pass them on."""

    def __init__(self, name: str, answers: dict[str, Answer]) -> None:
        """Answer the queries of each key as `answers` say; `name` is that of the thread."""
        self._name, self._answers = name, answers
        self._worker: ThreadPoolExecutor | None = None

    def start(self, sessions: Sessions) -> None:
        self._worker = ThreadPoolExecutor(1, self._name)
        self._worker.submit(lambda: None).result()
        for key in self._answers:
            sessions.serve(key, lambda incoming, key=key: self.post(lambda: self._answer(incoming, key)))  # type: ignore[misc]

    def post(self, work: Callable[[], None]) -> None:
        """Let the thread do some work; after `close` the calling thread does it."""
        try:
            if self._worker is not None:
                self._worker.submit(work)
        except RuntimeError:  # the worker is shut down
            work()

    def _answer(self, incoming: Incoming, key: str) -> None:
        incoming.reply(key, *incoming.raw.answer(self._answers[key](incoming)))
        incoming.finish()

    def close(self) -> None:
        """Answer the waiting queries, then end the thread."""
        if self._worker is not None:
            self._worker.shutdown()


def same(answer: Callable[[], msgspec.Struct]) -> Answer:
    """Return what gives all queries the same answer."""
    return lambda _: answer()


class StateQueries(QueryThread):
    """Answers state queries on a thread of its own."""

    def __init__(self, snapshot: Snapshot, events: NodeEvents) -> None:
        name, side = snapshot.name, snapshot.side
        answers: dict[str, Callable[[], msgspec.Struct]] = {
            keys.positions(name, side): snapshot.positions,
            keys.positions_json(name, side): snapshot.positions,
            keys.status(name, side): snapshot.status,
            keys.status_json(name, side): snapshot.status,
            keys.events(name, side): events.latest,
            keys.events_json(name, side): events.latest,
            keys.info(name, side): snapshot.info,
            keys.clock(name, side): snapshot.clock,
        }
        super().__init__("beatrix-queries", {key: same(answer) for key, answer in answers.items()})
        self._robot, self._side = name, side
        self._unknown = UnknownKeys(name, side)

    def start(self, sessions: Sessions) -> None:
        description = keys.program(self._robot, sessions.control.session_id)
        self._answers[description] = same(lambda: sessions.describe(self._side))
        super().start(sessions)
        for traffic, expressions in REST.items():
            for expression in expressions:
                sessions.session(traffic).serve(
                    f"{self._unknown.base}{expression}",
                    lambda incoming: self.post(lambda: self._refuse(incoming)),
                    self._unknown.has,
                )

    def _refuse(self, incoming: Incoming) -> None:
        incoming.reply_error(*incoming.raw.answer(self._unknown.error(incoming.key)))
        incoming.finish()
