"""A declared publisher, which outlives the session in which it was declared."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from typing import Final

import zenoh

from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.bus.query import PRIORITIES
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage

CONGESTION = {"drop": zenoh.CongestionControl.DROP, "block": zenoh.CongestionControl.BLOCK}


MATCHING_S: Final = 1.0
"""Age (s) at which the answer of Zenoh about subscribers is renewed, even if Zenoh has reported no change."""


class Publication:
    """A declared publisher, with the priority and congestion control of its row in keys.toml."""

    def __init__(self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None) -> None:
        self._key, self._encoding, self._on_subscribed = key, encoding, on_subscribed
        self._publisher: zenoh.Publisher
        self._matching = False
        self._read_s = float("-inf")
        """Time (s, monotonic) at which `_matching` was read; -inf: read it again."""
        self._reading = threading.Lock()
        """Held while Zenoh is asked: a thread that a change has woken must not get the answer from before."""

    def declare(self, session: zenoh.Session) -> zenoh.Publisher:
        """Declare the publisher on a session, in place of the publisher of an earlier session."""
        parts = keys.parse(self._key)
        row = None if parts is None else keys.KEYS[parts.row]
        self._publisher = session.declare_publisher(
            self._key,
            encoding=self._encoding,
            priority=PRIORITIES["data" if row is None else row.priority],
            congestion_control=CONGESTION["drop" if row is None else row.congestion],
        )
        # The listener ends with its publisher. Zenoh does not call a new one if the key has no subscribers, so call
        # `_changed` here.
        self._publisher.declare_matching_listener(direct(self._on_matching))
        self._changed()
        return self._publisher

    def _on_matching(self, _: zenoh.MatchingStatus) -> None:
        self._changed()

    def _changed(self) -> None:
        self._read_s = float("-inf")
        if self._on_subscribed is not None:
            self._on_subscribed()

    @property
    def subscribed(self) -> bool:
        """Whether any client subscribes to this publication."""
        with self._reading:
            now_s = time.monotonic()
            if now_s - self._read_s > MATCHING_S:
                self._read_s = now_s  # before the call, because a change may be reported during it
                self._matching = bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool
            return self._matching

    def put(self, payload: bytes, attachment: bytes | None = None) -> None:
        """Publish; Zenoh drops the message for a subscriber that cannot keep up."""
        with contextlib.suppress(zenoh.ZError, WrongUsage), OPEN.call():  # the session may be closing
            self._publisher.put(payload, attachment=attachment)
