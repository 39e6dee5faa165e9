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


class KeptReports:
    """Keeps reports while the router restarts for new accounts; they are gone when its process ends.

    Access rules see to it that a seat writes only its own, and that only the teacher reads.
    """

    def __init__(self, lessons: Collection[str]) -> None:
        """Keep reports of these lessons; a seat could fill memory and the teacher's table with invented names."""
        self._lock, self._lessons = threading.Lock(), frozenset(lessons)
        self._declared: tuple[object, ...] = ()
        """Subscriber and queryable, which end when nothing refers to them."""
        self._kept: dict[str, LessonState] = {}
        """by key"""

    def serve(self, session: zenoh.Session) -> None:
        """Keep what the clients of a router publish, and answer its queries, until the session is closed."""
        key = keys.lesson("*", "*")
        self._declared = (
            session.declare_subscriber(key, direct(self._keep)),
            session.declare_queryable(key, direct(self._answer), complete=True),
        )

    def _keep(self, sample: zenoh.Sample) -> None:
        """Keep one report: tries and hints never fall, and a passed lesson stays passed; called on Zenoh's thread."""
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        parts = keys.parse(key)
        if parts is None or parts.lesson not in self._lessons:
            return
        if sample.kind != zenoh.SampleKind.PUT or len(payload) > LARGEST:
            return
        with contextlib.suppress(BeatrixError):
            names.check_seat(parts.who)
            new = codec.decode(payload, LessonState)
            with self._lock:
                old = self._kept.get(key, new)
                self._kept[key] = structs.replace(
                    new,  # which may come from another folder of this seat
                    tries=max(old.tries, new.tries),
                    hints=max(old.hints, new.hints),
                    passed=old.passed or new.passed,
                )

    def _answer(self, query: zenoh.Query) -> None:
        """Reply with every report that matches; called on Zenoh's thread."""
        with self._lock:
            kept = list(self._kept.items())
        with contextlib.suppress(zenoh.ZError):  # the router is closing
            for key, state in kept:
                if query.key_expr.intersects(zenoh.KeyExpr(key)):
                    query.reply(key, codec.encode(state), encoding=codec.MSGPACK)
        query.drop()
