"""The reports of lessons that the router of a class keeps: the newest of each seat and lesson, in memory only."""

from __future__ import annotations

import contextlib
import threading
from typing import Final

import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage

LARGEST: Final = 400
"""Largest report that is kept (bytes); a usual one has about 60."""
LESSONS_MAX: Final = 64
"""Largest number of lessons that are kept of one seat."""


class KeptReports:
    """Keeps reports while the router restarts for new accounts; they are gone when its process ends.

    Access rules see to it that a seat writes only its own, and that only the teacher reads.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._declared: tuple[object, ...] = ()
        """Subscriber and queryable, which end when nothing refers to them."""
        self._kept: dict[str, dict[str, tuple[bytes, zenoh.Encoding]]] = {}

    def serve(self, session: zenoh.Session) -> None:
        """Keep what the clients of a router publish, and answer its queries, until the session is closed."""
        key = keys.lesson("*", "*")
        self._declared = (
            session.declare_subscriber(key, Callback(self._keep, indirect=False)),
            session.declare_queryable(key, Callback(self._answer, indirect=False), complete=True),
        )

    def _keep(self, sample: zenoh.Sample) -> None:
        """Keep one report; called on Zenoh's thread."""
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        parts = keys.parse(key)
        if parts is None or sample.kind != zenoh.SampleKind.PUT or len(payload) > LARGEST:
            return
        with contextlib.suppress(WrongUsage):
            names.check_seat(parts.who)
            with self._lock:
                seat = self._kept.setdefault(parts.who, {})
                if key in seat or len(seat) < LESSONS_MAX:
                    seat[key] = payload, sample.encoding

    def _answer(self, query: zenoh.Query) -> None:
        """Reply with every report that matches; called on Zenoh's thread."""
        with self._lock:
            kept = [(key, *report) for seat in self._kept.values() for key, report in seat.items()]
        with contextlib.suppress(zenoh.ZError):  # the router is closing
            for key, payload, encoding in kept:
                if query.key_expr.intersects(zenoh.KeyExpr(key)):
                    query.reply(key, payload, encoding=encoding)
        query.drop()
