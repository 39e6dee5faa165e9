"""Reports of lessons and shared gestures that the process of the routers of a class keeps, in memory only."""

from __future__ import annotations

import contextlib
from collections.abc import Collection
from typing import Final

from msgspec import structs

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client.own_gestures import LARGEST_BYTES, MOST
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LessonState, SharedGesture
from beatrix_zenoh.contract.errors import BeatrixError

LARGEST: Final = 400
"""Largest report that is kept (bytes); a usual one has about 60."""
LARGEST_GESTURE: Final = 2 * LARGEST_BYTES
"""Largest message with a gesture that is kept (bytes)."""
GESTURES_MAX: Final = MOST
"""Number of gestures of a seat that are kept, the newest."""


class KeptReports:
    """Keeps reports and gestures while the routers restart; access rules see to it that a seat writes only its own.

    A seat may work in several folders: tries and hints never fall, and a lesson that was passed stays passed.
    """

    def __init__(self, bus: zbus.Bus, lessons: Collection[str]) -> None:
        """Serve until `bus` is closed; a seat could fill memory and the teacher's table with names of other lessons."""
        self._lessons = frozenset(lessons)
        self._kept: dict[str, LessonState] = {}
        """by key"""
        self._gestures: dict[str, SharedGesture] = {}
        """by key"""
        for key, keep in ((keys.lesson, self._keep), (keys.gesture, self._keep_gesture)):
            bus.subscribe(key("*", "*"), keep)
            bus.serve(key("*", "*"), self._answer)

    def _keep(self, report: zbus.Received) -> None:
        parts = keys.parse(report.key)
        if parts is None or parts.lesson not in self._lessons or len(report.payload) > LARGEST:
            return
        with contextlib.suppress(BeatrixError):
            names.check_seat(parts.who)
            new = codec.decode(report.payload, LessonState)
            old = self._kept.get(report.key, new)
            self._kept[report.key] = structs.replace(
                new,
                tries=max(old.tries, new.tries),
                hints=max(old.hints, new.hints),
                passed=old.passed or new.passed,
            )

    def _keep_gesture(self, shared: zbus.Received) -> None:
        parts = keys.parse(shared.key)
        if parts is None or len(shared.payload) > LARGEST_GESTURE:
            return
        with contextlib.suppress(BeatrixError):
            names.check_seat(parts.who)
            new, seat = codec.decode(shared.payload, SharedGesture), keys.gesture(parts.who, "")
            others = [key for key in self._gestures if key.startswith(seat) and key != shared.key]
            for oldest in others[: max(0, len(others) - GESTURES_MAX + 1)]:
                del self._gestures[oldest]
            self._gestures.pop(shared.key, None)  # so that it is the newest
            self._gestures[shared.key] = new

    def _answer(self, incoming: zbus.Incoming) -> None:
        for key, kept in [*self._kept.items(), *self._gestures.items()]:
            if zbus.intersects(incoming.key, key):
                incoming.reply(key, codec.encode(kept), codec.MSGPACK)
        incoming.finish()
