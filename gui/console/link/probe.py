"""Queries to each robot: its clock once a second, which gives the round trip, and its limits once."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from typing import TypeVar

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Clock, Info, LimitInfo
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session

PERIOD_S = 1.0
ANSWER_S = 1.0

M = TypeVar("M", bound=msgspec.Struct)


class Probe:
    """Queries one robot on a thread of its own, so that a silent robot does not delay queries to the other."""

    def __init__(self, side: str, session: Callable[[], Session | None]) -> None:
        """Start the thread; `session` returns the present session, or None."""
        self._side, self._session = side, session
        self.round_trip_s: float | None = None
        """duration (s) of the last query of the clock; None: the robot did not answer, or no query was sent"""
        self._limits: tuple[Place, LimitInfo] | None = None
        self._end: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._thread: threading.Thread = threads.start(self._run, f"window-probe-{side}")

    def limits(self, robot: str) -> LimitInfo | None:
        """Return the limits of the robot of this name; None if it has not answered since it came online."""
        known = self._limits
        return known[1] if known is not None and known[0] == (robot, self._side) else None

    def _run(self) -> None:
        while True:
            self._query()
            try:
                self._end.get(timeout=PERIOD_S)
            except queue.Empty:
                continue
            return

    def _query(self) -> None:
        session = self._session()
        place = None if session is None else (session.twin.name, self._side)
        if session is None or place is None or place not in session.monitor.present():
            self.round_trip_s = self._limits = None  # the next robot of this name may have other limits
            return
        began_s = time.monotonic()
        clock = reply_of(session.client, place, keys.clock(*place), Clock)
        self.round_trip_s = None if clock is None else time.monotonic() - began_s
        if clock is not None and self.limits(place[0]) is None:
            info = reply_of(session.client, place, keys.info(*place), Info)
            self._limits = None if info is None else (place, info.limits)

    def close(self) -> None:
        """End the thread; returns at once."""
        self._end.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the thread until `deadline_s` (monotonic clock, s)."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))


def reply_of(client: Client, place: Place, key: str, kind: type[M]) -> M | None:
    """Return the reply of a robot to a query without arguments; None if none arrives within ANSWER_S."""
    try:
        request = Request(client, place, key, None, ANSWER_S)
        try:
            return request.reply(kind, ANSWER_S)
        finally:
            request.close()
    except (BeatrixError, TimeoutError):
        return None
