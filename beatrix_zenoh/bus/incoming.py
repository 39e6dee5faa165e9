"""What a session receives: queries to answer, and publications, which may wait in a bounded ring of Zenoh."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable
from typing import Final

import msgspec
import zenoh
from zenoh.handlers import RingChannel

from beatrix_zenoh import threads
from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.declarations import Declared
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract.errors import WrongUsage


class Incoming:
    """A query to answer; call `finish` at the end, because otherwise the client waits until its timeout."""

    def __init__(self, query: zenoh.Query) -> None:
        # Only the key is read here, because in a flood of queries newer ones replace most of them before decoding.
        self._query = query
        self.key = str(query.key_expr)
        self._raw: RawQuery | None = None

    @property
    def raw(self) -> RawQuery:
        """Payload, encoding and parameters; the first access must come before `finish`."""
        if self._raw is None:
            payload, encoding = self._query.payload, self._query.encoding
            self._raw = RawQuery(
                payload=b"" if payload is None else payload.to_bytes(),
                encoding="" if encoding is None else str(encoding),
                parameters=str(self._query.parameters),
            )
        return self._raw

    @property
    def attachment(self) -> bytes:
        """The attachment; empty if there is none. Read it before `finish`."""
        attachment = self._query.attachment
        return b"" if attachment is None else attachment.to_bytes()

    @property
    def session(self) -> str:
        """Id of the client's session; empty if the query has no source info."""
        source = self._query.source_info
        return "" if source is None else str(source.source_id.zid)

    def reply(self, key: str, payload: bytes, encoding: str) -> None:
        """Send one reply on `key`, the robot's own; raises no error if the client has gone."""
        with contextlib.suppress(zenoh.ZError, WrongUsage), OPEN.call():
            self._query.reply(key, payload, encoding=encoding)

    def reply_error(self, payload: bytes, encoding: str) -> None:
        """Send an error reply, which has no key; raises no error if the client has gone."""
        with contextlib.suppress(zenoh.ZError):
            self._query.reply_err(payload, encoding=encoding)

    def finish(self) -> None:
        """End the replies to this query."""
        with contextlib.suppress(WrongUsage), OPEN.call():
            self._query.drop()


class Received(msgspec.Struct, frozen=True, gc=False):
    """A received publication, and its arrival by the clocks of this computer (ns)."""

    key: str
    payload: bytes
    sender: str
    """id of the publisher's session; empty if unknown"""
    attachment: bytes | None
    t_mono_ns: int
    t_wall_ns: int

    @property
    def header(self) -> Received:
        """The attachment of a picture or of sound, to be read as a message."""
        return msgspec.structs.replace(self, payload=self.attachment or b"")

    @classmethod
    def of(cls, sample: zenoh.Sample) -> Received:
        """Return the data of Zenoh's object."""
        source, attachment = sample.source_info, sample.attachment
        return cls(
            str(sample.key_expr),
            sample.payload.to_bytes(),
            "" if source is None else str(source.source_id.zid),
            None if attachment is None else attachment.to_bytes(),
            time.monotonic_ns(),
            time.time_ns(),
        )


WAITING: Final = 1024
"""Publications that wait for the thread; of more the oldest are dropped."""


def subscribe_newest(
    session: zenoh.Session, key: str, handle: Callable[[Received], None], skips: Callable[[str], bool]
) -> Declared:
    """Pass publications on `key` to `handle` in a thread, except those for whose key `skips` returns True.

    A callback would delay everything else that the session receives: a flood of 300 000 publications per second delayed
    queries by 0.2 s. Zenoh drops what the ring cannot hold, without Python, and a query waits for none of it. The thread
    ends with the subscription or the session.
    """
    subscriber = session.declare_subscriber(key, RingChannel(WAITING))
    # While a thread waits in `subscriber.recv`, the subscriber cannot be undeclared.
    ring = subscriber.handler

    def receive() -> None:
        with OPEN.call(), contextlib.suppress(zenoh.ZError):  # the subscription has ended
            while True:
                sample = ring.recv()
                try:
                    if not skips(str(sample.key_expr)):
                        handle(Received.of(sample))
                except Exception as error:  # noqa: BLE001 # the next publication must still arrive
                    threads.show_error(error)

    threads.start(receive, "newest")
    return subscriber
