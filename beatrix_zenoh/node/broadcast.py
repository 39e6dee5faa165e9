"""The publisher's thread: positions 50 times a second, status on change and once a second."""

from __future__ import annotations

import threading
import time

import msgspec

from beatrix_zenoh import codec, threads
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Status
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.node.reporter import Reporter

PERIOD_S = 1 / keys.POSITIONS_HZ
STATUS_S = 1.0


class Broadcast:
    """Publishes until closed; the JSON twins only while somebody listens."""

    def __init__(self, bus: Bus, reporter: Reporter, name: str, twin: str) -> None:
        self._reporter = reporter
        self._positions = bus.publication(keys.positions(name, twin), codec.MSGPACK, "interactive_high")
        self._positions_json = bus.publication(keys.positions_json(name, twin), codec.JSON)
        self._status = bus.publication(keys.status(name, twin), codec.MSGPACK)
        self._status_json = bus.publication(keys.status_json(name, twin), codec.JSON)
        self._shown: tuple[object, ...] = ()
        self._status_due_s = 0.0
        self._closed = threading.Event()
        self._thread = threads.start(self._run, "broadcast")

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            positions = self._reporter.positions(count=True)
            self._positions.put(codec.encode(positions))
            if self._positions_json.watched:
                self._positions_json.put(codec.encode_json(positions))
            self._show_status()
            due = max(due + PERIOD_S, time.monotonic() - PERIOD_S)  # after a stall: no burst of old news

    def _show_status(self, *, always: bool = False) -> None:
        status = self._reporter.status()
        shown = essence(status)
        now = time.monotonic()
        if always or shown != self._shown or now >= self._status_due_s:
            self._shown, self._status_due_s = shown, now + STATUS_S
            self._status.put(codec.encode(status))
            if self._status_json.watched:
                self._status_json.put(codec.encode_json(status))

    def close(self) -> None:
        """Publish a last status and end."""
        self._closed.set()
        self._thread.join(timeout=2.0)
        self._show_status(always=True)


def essence(status: Status) -> tuple[object, ...]:
    """What of a status is worth publishing at once: everything but clocks and the plant's counters."""
    return msgspec.structs.astuple(status)[2:-1]
