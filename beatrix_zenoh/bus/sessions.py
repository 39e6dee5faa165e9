"""The Zenoh sessions of a process.

Each traffic class has one, so that a flood in one class does not delay the others.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from beatrix_zenoh.bus.description import describe
from beatrix_zenoh.bus.incoming import Incoming, Received
from beatrix_zenoh.bus.publication import Publication
from beatrix_zenoh.bus.session import Bus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import ProgramInfo

CONTROL = "control"
"""Traffic class of tokens, STOP and commands; its session is always open and is closed last."""


class Sessions:
    """The sessions by traffic class of keys.toml; Zenoh delivers all data of one session in order.

    The session of a class is opened when this process first serves, subscribes to or publishes a key of the class.
    """

    def __init__(self, connect: Callable[[], Bus]) -> None:
        """Open the control session; raises the errors of `connect` (NoAnswer: no router)."""
        self._connect = connect
        self._lock = threading.Lock()
        self._open: dict[str, Bus] = {CONTROL: connect()}

    @property
    def control(self) -> Bus:
        """The control session."""
        return self._open[CONTROL]

    def session(self, traffic: str) -> Bus:
        """Return the session of a traffic class, opened if necessary; raises the errors of `connect`."""
        with self._lock:
            if traffic not in self._open:
                self._open[traffic] = self._connect()
            return self._open[traffic]

    def opened(self) -> dict[str, Bus]:
        """Return the open sessions by traffic class."""
        with self._lock:
            return dict(self._open)

    def serve(self, key: str, handle: Callable[[Incoming], None]) -> None:
        """Pass queries on `key`, a key of keys.toml, to `handle`, as `Bus.serve` does."""
        self.session(_row(key).session).serve(key, handle)

    def subscribe(self, key: str, handle: Callable[[Received], None]) -> Callable[[], None]:
        """Pass publications on `key` to `handle`, as `Bus.subscribe` does."""
        return self.session(_row(key).session).subscribe(key, handle)

    def subscribe_newest(
        self, key: str, handle: Callable[[Received], None], skips: Callable[[str], bool]
    ) -> None:
        """Pass publications on `key` to `handle`, as `Bus.subscribe_newest` does."""
        self.session(_row(key).session).subscribe_newest(key, handle, skips)

    def publication(
        self, key: str, encoding: str, on_subscribed: Callable[[], None] | None = None
    ) -> Publication:
        """Declare a publication, as `Bus.publication` does."""
        return self.session(_row(key).publish).publication(key, encoding, on_subscribed)

    def describe(self, side: str) -> ProgramInfo:
        """Return the description of the node that owns these sessions."""
        return describe(self.opened().values(), side)

    def close(self) -> None:
        """Close all sessions, the control session last. May be called twice."""
        for traffic, bus in sorted(self.opened().items(), key=lambda entry: entry[0] == CONTROL):
            bus.close()
            if traffic != CONTROL:
                del self._open[traffic]


def _row(key: str) -> keys.KeyRow:
    parts = keys.parse(key)
    if parts is None:
        raise ValueError(f"{key!r} is not a key of schemas/keys.toml")
    return keys.KEYS[parts.row]
