"""A declared publisher, which outlives the session in which it was declared."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import zenoh
from zenoh.handlers import Callback

from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.query import PRIORITIES
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage

CONGESTION = {"drop": zenoh.CongestionControl.DROP, "block": zenoh.CongestionControl.BLOCK}


class Publication:
    """A declared publisher, with the priority and congestion control of its row in keys.toml."""

    def __init__(self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None) -> None:
        self._key, self._encoding, self._on_subscribed = key, encoding, on_subscribed
        self._publisher: zenoh.Publisher

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
        on_subscribed = self._on_subscribed
        if on_subscribed is not None:
            # The listener ends with its publisher. Zenoh does not call a new one if the key has no subscribers, so call
            # `on_subscribed` here.
            changed: Callback[zenoh.MatchingStatus] = Callback(lambda _: on_subscribed(), indirect=False)
            self._publisher.declare_matching_listener(changed)
            on_subscribed()
        return self._publisher

    @property
    def subscribed(self) -> bool:
        """Whether any client subscribes to this publication."""
        return bool(self._publisher.matching_status.matching)  # type: ignore[attr-defined]  # the stub says bool

    def put(self, payload: bytes, attachment: bytes | None = None) -> None:
        """Publish; Zenoh drops the message for a subscriber that cannot keep up."""
        with contextlib.suppress(zenoh.ZError, WrongUsage), OPEN.call():  # the session may be closing
            self._publisher.put(payload, attachment=attachment)
