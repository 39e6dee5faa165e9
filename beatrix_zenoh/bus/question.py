"""Asking: a query and its replies as they come."""

from __future__ import annotations

import contextlib
import queue
from collections.abc import Callable
from dataclasses import dataclass

import zenoh
from zenoh.handlers import Callback

FOR_EVER_S = 24 * 3600.0

PRIORITIES = {
    "real_time": zenoh.Priority.REAL_TIME,
    "interactive_high": zenoh.Priority.INTERACTIVE_HIGH,
    "data": zenoh.Priority.DATA,
    "data_low": zenoh.Priority.DATA_LOW,
}


@dataclass(frozen=True)
class Answer:
    """One reply to `ask`: the key it came on, payload, encoding, and whether it is an error reply."""

    key: str
    payload: bytes
    encoding: str
    error: bool


class Question:
    """An `ask` under way: replies as they come, each waited for with its own time-out."""

    def __init__(
        self, session: zenoh.Session, key: str, payload: bytes | None, encoding: str | None, priority: str
    ) -> None:
        self._inbox: queue.SimpleQueue[Answer | None] = queue.SimpleQueue()
        self._cancel = zenoh.CancellationToken()
        self._late: Callable[[Answer], None] | None = None
        session.get(
            key,
            Callback(self._receive, drop=lambda: self._inbox.put(None), indirect=False),
            payload=payload,
            encoding=encoding,
            consolidation=zenoh.ConsolidationMode.NONE,
            priority=PRIORITIES[priority],
            timeout=FOR_EVER_S,
            source_info=zenoh.SourceInfo(session.id, 0),
            cancellation_token=self._cancel,
        )

    def _receive(self, reply: zenoh.Reply) -> None:
        good = reply.ok
        if good is not None:
            answer = Answer(str(good.key_expr), good.payload.to_bytes(), str(good.encoding), error=False)
        else:
            bad = reply.err
            if bad is None:
                return
            answer = Answer("", bad.payload.to_bytes(), str(bad.encoding), error=True)
        if self._late is None:
            self._inbox.put(answer)
        else:
            self._late(answer)

    def next(self, timeout_s: float) -> Answer | None:
        """The next reply; None when there will be no more.

        Raises:
            TimeoutError: nothing came within `timeout_s`; the question stays open.
        """
        try:
            return self._inbox.get(timeout=max(0.0, timeout_s))
        except queue.Empty:
            raise TimeoutError from None

    def hand_over(self, handle: Callable[[Answer], None]) -> None:
        """Nobody waits any more: `handle` gets what is there and what comes, on Zenoh's thread."""
        self._late = handle
        with contextlib.suppress(queue.Empty):
            while (answer := self._inbox.get_nowait()) is not None:
                handle(answer)

    def close(self) -> None:
        """Wait for no more replies."""
        self._cancel.cancel()
