"""Queries that a thread of their own answers, because Zenoh's threads must not wait."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import msgspec

from beatrix_zenoh.bus import Incoming, Sessions
from beatrix_zenoh.node.interfaces import Component

Answer = Callable[[Incoming], msgspec.Struct]
"""Returns the reply to a query."""


class QueryThread(Component):
    """Answers the queries of some keys, one after the other; Zenoh's threads only pass them on."""

    def __init__(self, name: str, answers: dict[str, Answer]) -> None:
        """Answer the queries of each key as `answers` say; `name` is that of the thread."""
        self._name, self._answers = name, answers
        self._worker: ThreadPoolExecutor | None = None

    def start(self, sessions: Sessions) -> None:
        self._worker = ThreadPoolExecutor(1, self._name)
        self._worker.submit(lambda: None).result()
        for key in self._answers:
            sessions.serve(key, lambda incoming, key=key: self.post(lambda: self._answer(incoming, key)))  # type: ignore[misc]

    def post(self, work: Callable[[], None]) -> None:
        """Let the thread do some work; after `close` the calling thread does it."""
        try:
            if self._worker is not None:
                self._worker.submit(work)
        except RuntimeError:  # the worker is shut down
            work()

    def _answer(self, incoming: Incoming, key: str) -> None:
        incoming.reply(key, *incoming.raw.answer(self._answers[key](incoming)))
        incoming.finish()

    def close(self) -> None:
        """Answer the waiting queries, then end the thread."""
        if self._worker is not None:
            self._worker.shutdown()
