"""What a session receives: queries to answer, and publications."""

from __future__ import annotations

import contextlib
from functools import cached_property

import msgspec
import zenoh

from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract.errors import WrongUsage


class Incoming:
    """A query to answer; call `finish` at the end, because otherwise the client waits until its timeout."""

    def __init__(self, query: zenoh.Query) -> None:
        # Only the key is read here, because in a flood of queries newer ones replace most of them before decoding.
        self._query = query
        self.key = str(query.key_expr)

    @cached_property
    def raw(self) -> RawQuery:
        """Payload, encoding and parameters; the first access must come before `finish`."""
        payload, encoding = self._query.payload, self._query.encoding
        return RawQuery(
            payload=b"" if payload is None else payload.to_bytes(),
            encoding="" if encoding is None else str(encoding),
            parameters=str(self._query.parameters),
        )

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
    """A received publication."""

    key: str
    payload: bytes
    session: str
    """id of the publisher's session; empty if unknown"""
    attachment: bytes | None

    @classmethod
    def of(cls, sample: zenoh.Sample) -> Received:
        """Return the data of Zenoh's object."""
        source, attachment = sample.source_info, sample.attachment
        return cls(
            str(sample.key_expr),
            sample.payload.to_bytes(),
            "" if source is None else str(source.source_id.zid),
            None if attachment is None else attachment.to_bytes(),
        )
