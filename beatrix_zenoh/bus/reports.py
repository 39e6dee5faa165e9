"""The reports of lessons that the router of a class keeps: one for each seat and lesson, in memory only."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Collection
from typing import Final

import zenoh
from msgspec import structs

from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LessonState
from beatrix_zenoh.contract.errors import BeatrixError

LARGEST: Final = 400
"""Largest report that is kept (bytes); a usual one has about 60."""
FOLDERS_MAX: Final = 8
"""Largest number of folders of one seat whose tries are told apart."""
MOST: Final = 2**16 - 1


class SeatReport:
    """What a seat has reached in one lesson, in all folders that it has used for it.

    A report counts the tries of one folder and does not name it. So a report with fewer tries than all before comes
    from another folder; otherwise it comes from the folder that had the most tries of those that had no more.
    """

    def __init__(self, state: LessonState) -> None:
        self.state = state
        """the newest report, with the tries of all folders"""
        self._tries = [state.tries]
        """of each folder, in ascending order"""

    def add(self, new: LessonState) -> None:
        """Add a report: tries and hints never fall, and a lesson that was passed stays passed."""
        older = [tries for tries in self._tries if tries <= new.tries]
        if older:
            self._tries.remove(older[-1])
        elif len(self._tries) == FOLDERS_MAX:
            self._tries[-2:] = [sum(self._tries[-2:])]
        self._tries = sorted([*self._tries, new.tries])
        self.state = structs.replace(
            new,
            tries=min(sum(self._tries), MOST),
            hints=max(self.state.hints, new.hints),
            passed=self.state.passed or new.passed,
        )


class KeptReports:
    """Keeps reports while the router restarts for new accounts; they are gone when its process ends.

    Access rules see to it that a seat writes only its own, and that only the teacher reads.
    """

    def __init__(self, lessons: Collection[str]) -> None:
        """Keep reports of these lessons; a seat could fill memory and the teacher's table with invented names."""
        self._lock, self._lessons = threading.Lock(), frozenset(lessons)
        self._declared: tuple[object, ...] = ()
        """Subscriber and queryable, which end when nothing refers to them."""
        self._kept: dict[str, SeatReport] = {}
        """by key"""

    def serve(self, session: zenoh.Session) -> None:
        """Keep what the clients of a router publish, and answer its queries, until the session is closed."""
        key = keys.lesson("*", "*")
        self._declared = (
            session.declare_subscriber(key, direct(self._keep)),
            session.declare_queryable(key, direct(self._answer), complete=True),
        )

    def _keep(self, sample: zenoh.Sample) -> None:
        """Keep one report; called on Zenoh's thread."""
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        parts = keys.parse(key)
        if parts is None or parts.lesson not in self._lessons:
            return
        if sample.kind != zenoh.SampleKind.PUT or len(payload) > LARGEST:
            return
        with contextlib.suppress(BeatrixError):
            names.check_seat(parts.who)
            state = codec.decode(payload, LessonState)
            with self._lock:
                if key in self._kept:
                    self._kept[key].add(state)
                else:
                    self._kept[key] = SeatReport(state)

    def _answer(self, query: zenoh.Query) -> None:
        """Reply with every report that matches; called on Zenoh's thread."""
        with self._lock:
            kept = [(key, report.state) for key, report in self._kept.items()]
        with contextlib.suppress(zenoh.ZError):  # the router is closing
            for key, state in kept:
                if query.key_expr.intersects(zenoh.KeyExpr(key)):
                    query.reply(key, codec.encode(state), encoding=codec.MSGPACK)
        query.drop()
