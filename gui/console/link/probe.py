"""Queries to each robot: its clock once a second, which gives the round trip, and its limits once."""

from __future__ import annotations

import math
import time
from typing import TypeVar

import msgspec

from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Clock, Info, LimitInfo
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs

PERIOD_S = 1.0
ANSWER_S = 1.0

M = TypeVar("M", bound=msgspec.Struct)


class Probe:
    """Queries one robot in a queue of its own, so that a silent robot does not delay queries to the other."""

    def __init__(self, side: str, jobs: Jobs) -> None:
        self._side, self._jobs = side, jobs
        self._due_s = 0.0
        """when to query again (monotonic clock, s); infinite while a query is under way"""
        self.round_trip_s: float | None = None
        """duration (s) of the last query of the clock; None: the robot did not answer, or no query was sent"""
        self._limits: tuple[Place, LimitInfo] | None = None

    def limits(self, robot: str) -> LimitInfo | None:
        """Return the limits of the robot of this name; None if it has not answered since it came online."""
        known = self._limits
        return known[1] if known is not None and known[0] == (robot, self._side) else None

    def look(self, session: Session | None, now_s: float) -> None:
        """Query the robot again if it is time; returns at once. Call it in one thread only."""
        place = ("" if session is None else session.twin.name, self._side)
        if session is None or place not in session.monitor.present():
            self.round_trip_s = self._limits = None  # the next robot of this name may have other limits
        elif now_s >= self._due_s:
            self._due_s = math.inf
            client = session.client
            self._jobs.put(f"probe-{self._side}", lambda: self._query(client, place))

    def _query(self, client: Client, place: Place) -> None:
        began_s = time.monotonic()
        try:
            clock = reply_of(client, place, keys.clock(*place), Clock)
            self.round_trip_s = None if clock is None else time.monotonic() - began_s
            if clock is not None and self.limits(place[0]) is None:
                info = reply_of(client, place, keys.info(*place), Info)
                self._limits = None if info is None else (place, info.limits)
        finally:
            self._due_s = time.monotonic() + PERIOD_S


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
