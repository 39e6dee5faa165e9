"""A query and its replies."""

from __future__ import annotations

import contextlib
import queue
import time
from collections.abc import Callable, Iterator
from functools import lru_cache

import msgspec
import zenoh

from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.bus.callbacks import direct
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import WrongUsage

QUERY_S = 60.0
"""Timeout (s) of a query if the caller gives none."""
PRIORITIES = {
    "real_time": zenoh.Priority.REAL_TIME,
    "interactive_high": zenoh.Priority.INTERACTIVE_HIGH,
    "data": zenoh.Priority.DATA,
    "data_low": zenoh.Priority.DATA_LOW,
}
TIMED_OUT = b"Timeout"
"""Payload of the error reply that Zenoh creates when the timeout of a query has passed."""


@lru_cache(maxsize=256)
def priority_of(selector: str, priority: str | None = None) -> zenoh.Priority:
    """Return the named priority; without a name, that of the key's row in keys.toml, or `data` for other keys."""
    if priority is None:
        parts = keys.parse(selector.partition("?")[0])
        priority = "data" if parts is None else keys.KEYS[parts.row].priority
    return PRIORITIES[priority]


def intersects(one: str, other: str) -> bool:
    """Return whether any key matches both key expressions, which may contain `*` and `**`; False for invalid ones."""
    try:
        return zenoh.KeyExpr(one).intersects(zenoh.KeyExpr(other))
    except zenoh.ZError:
        return False


class Reply(msgspec.Struct, frozen=True):
    """One reply. Its sender is converted to text when it is read, which is rare."""

    key: str
    """empty: it is an error reply"""
    payload: bytes
    origin: zenoh.EntityGlobalId | None = None

    @property
    def error(self) -> bool:
        """Whether it is an error reply."""
        return not self.key

    @property
    def sender(self) -> str:
        """The session of the sender; empty if unknown."""
        return "" if self.origin is None else str(self.origin.zid)


class Query:
    """A query that was sent, and its replies as they arrive.

    The target is ALL: with Zenoh's default a complete queryable of another program, for example a storage on
    `beatrix/**`, would get the query instead of the robot. Zenoh keeps 0.8 kB for each query until its timeout has
    passed, even if it was answered, so choose a short `timeout_s`.
    """

    def __init__(
        self,
        session: zenoh.Session,
        key: str,
        payload: bytes | None,
        encoding: str | None,
        priority: str | None = None,
        timeout_s: float = QUERY_S,
        attachment: bytes | None = None,
    ) -> None:
        self._inbox: queue.SimpleQueue[Reply | None] = queue.SimpleQueue()
        self._cancel = zenoh.CancellationToken()
        self._late: Callable[[Reply], None] | None = None
        self._notify: Callable[[], None] | None = None
        session.get(
            key,
            direct(self._receive, self._end),
            payload=payload,
            encoding=encoding,
            attachment=attachment,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            priority=priority_of(key, priority),
            timeout=timeout_s,
            source_info=zenoh.SourceInfo(session.id, 0),
            cancellation_token=self._cancel,
        )

    def _receive(self, reply: zenoh.Reply) -> None:
        replier, good = reply.replier_id, reply.ok
        if good is not None:
            answer = Reply(str(good.key_expr), good.payload.to_bytes(), replier)
        else:
            bad = reply.err
            if bad is None:
                return
            payload = bad.payload.to_bytes()
            if replier is None and payload == TIMED_OUT:
                return  # Zenoh created it, not a robot; the end of the replies follows
            answer = Reply("", payload, replier)
        if self._late is None:
            self._inbox.put(answer)
            self._wake()
        else:
            self._late(answer)

    def _end(self) -> None:
        self._inbox.put(None)
        self._wake()

    def _wake(self) -> None:
        if self._notify is not None:
            self._notify()

    def next(self, timeout_s: float) -> Reply | None:
        """Return the next reply, or None if no more will come.

        Raises:
            TimeoutError: no reply within `timeout_s`; the query stays open.
        """
        try:
            answer = self._inbox.get(timeout=max(0.0, timeout_s))
        except queue.Empty:
            raise TimeoutError from None
        if answer is None:
            self._inbox.put(None)  # the next call also returns None
        return answer

    def replies(self, lasts_s: float) -> Iterator[Reply]:
        """Yield the replies that arrive within `lasts_s` (s) from the first step on, then close the query."""
        deadline_s = time.monotonic() + lasts_s
        try:
            while (answer := self.next(deadline_s - time.monotonic())) is not None:
                yield answer
        except TimeoutError:
            return
        finally:
            self.close()

    def is_answered(self, lasts_s: float) -> bool:
        """Return whether a reply arrives within `lasts_s` (s), then close the query."""
        return next(self.replies(lasts_s), None) is not None

    def notify(self, notify: Callable[[], None]) -> None:
        """Call `notify` on Zenoh's thread after each reply and at the end; and now, in this thread, if one has come.

        `notify` must return at once, like every callback of Zenoh.
        """
        self._notify = notify
        if not self._inbox.empty():
            notify()

    def hand_over(self, handle: Callable[[Reply], None]) -> None:
        """Pass the waiting replies to `handle` now, and later replies on Zenoh's thread."""
        self._late = handle
        with contextlib.suppress(queue.Empty):
            while (answer := self._inbox.get_nowait()) is not None:
                handle(answer)

    def close(self) -> None:
        """Cancel the query and discard further replies."""
        with contextlib.suppress(WrongUsage), OPEN.call():
            self._cancel.cancel()
