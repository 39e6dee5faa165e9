"""The publisher's thread: positions at 50 Hz, status on change and once a second, events within 20 ms."""

from __future__ import annotations

import threading
import time

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Publication, Sessions
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import NOT_ON_CHANGE, EventKind, Fault, Reason, Status
from beatrix_zenoh.node.component import Component
from beatrix_zenoh.node.context import Context
from beatrix_zenoh.node.events import EventLog
from beatrix_zenoh.node.lease import Caller


class StatusEvents:
    """Compares each status with the previous one, and records changes as events."""

    def __init__(self, events: EventLog) -> None:
        self._events = events
        self._holder = ""
        self._trouble = ""

    def record(self, status: Status) -> None:
        """Record another holder, and a lost or connected board, as events."""
        if status.holder != self._holder:
            text = f"{status.holder} drives." if status.holder else f"{self._holder} has freed the robot."
            self._events.add(EventKind.LEASE, caller=Caller(status.holder, ""), message=text)
        trouble = board_trouble(status)
        if trouble != self._trouble:
            reason = Reason.BOARD_LOST if trouble else Reason.OK
            text = trouble or f"The board at {status.board.port} is connected."
            self._events.add(EventKind.BOARD, reason=reason, message=text)
        self._holder, self._trouble = status.holder, trouble


def board_trouble(status: Status) -> str:
    """Return why the board is not connected, as a sentence; empty if it is connected."""
    lost = not status.board.connected or status.fault in (Fault.BOARD_LOST, Fault.CONTRACT_MISMATCH)
    return status.warnings[0] if lost and status.warnings else ""


PERIOD_S = 1 / keys.POSITIONS_HZ
STATUS_S = 1 / keys.STATUS_HZ
ON_CHANGE = {
    kind: [name for name in kind.__struct_fields__ if name not in quiet]
    for kind, quiet in NOT_ON_CHANGE.items()
}
"""Fields whose change is published at once, by message; clocks and rates, which always change, are left out."""


class Stream:
    """Publications of one kind of message in msgpack, and as JSON text while a client subscribes to the JSON key."""

    def __init__(self, sessions: Sessions, key: str, json_key: str) -> None:
        self._packed: Publication = sessions.publication(key, codec.MSGPACK)
        self._json: Publication = sessions.publication(json_key, codec.JSON)

    def put(self, message: msgspec.Struct) -> None:
        """Publish a message; Zenoh drops it for a subscriber that cannot keep up."""
        self._packed.put(codec.encode(message))
        if self._json.subscribed:
            self._json.put(codec.encode_json(message))


class Publisher(Component):
    """Publishes positions, status and events until closed."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._changes = StatusEvents(context.events)
        self._published: object = None
        self._status_due_s = 0.0
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        name, side = self._context.name, self._context.side
        self._positions = Stream(sessions, keys.positions(name, side), keys.positions_json(name, side))
        self._status = Stream(sessions, keys.status(name, side), keys.status_json(name, side))
        self._events = Stream(sessions, keys.events(name, side), keys.events_json(name, side))
        self._thread = threads.start(self._run, "publisher")

    def _run(self) -> None:
        due_s = time.monotonic()
        while not self._closed.wait(max(0.0, due_s - time.monotonic())):
            self._positions.put(self._context.snapshot.positions(count=True))
            self._publish_status()
            self._publish_events()
            # After a stall of the process, skip the missed publications: clients need no burst of old positions.
            due_s = max(due_s + PERIOD_S, time.monotonic() - PERIOD_S)

    def _publish_status(self, *, always: bool = False) -> None:
        status = self._context.snapshot.status()
        values = change_fields(status)
        now_s = time.monotonic()
        if values != self._published:
            self._changes.record(status)
        if always or values != self._published or now_s >= self._status_due_s:
            self._published, self._status_due_s = values, now_s + STATUS_S
            self._status.put(status)

    def _publish_events(self) -> None:
        for event in self._context.events.take():
            self._events.put(event)

    def close(self) -> None:
        """End the thread; publish a last status and the last events."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
            self._publish_status(always=True)
            self._publish_events()


def change_fields(value: object) -> object:
    """Return the fields of a status, and of its parts, whose change is published at once."""
    if isinstance(value, list):
        return [change_fields(one) for one in value]
    if isinstance(value, msgspec.Struct) and type(value) in ON_CHANGE:
        return [change_fields(getattr(value, name)) for name in ON_CHANGE[type(value)]]
    return value
