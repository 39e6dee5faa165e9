"""A thread that runs the user's callbacks, because Zenoh's own threads must not be blocked."""

from __future__ import annotations

import heapq
import itertools
import logging
import queue
import threading
import time
from collections.abc import Callable

from beatrix_zenoh import threads

LOG = logging.getLogger("beatrix_zenoh.client")


class Dispatcher:
    """Runs calls in order, at once or at given times, in a thread that starts with the first call.

    Exceptions of calls are logged.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls: queue.SimpleQueue[tuple[float, Callable[[], object]] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self._closed = False

    def call(self, do: Callable[[], object], at_s: float = 0.0) -> None:
        """Run `do` in the dispatcher's thread, not before `at_s` (monotonic clock, s)."""
        with self._lock:
            if self._closed:
                return
            if self._thread is None:
                self._thread = threads.start(self._run, "callbacks")
        self._calls.put((at_s, do))

    def _run(self) -> None:
        later: list[tuple[float, int, Callable[[], object]]] = []
        numbers = itertools.count()
        while True:
            timeout_s = max(0.0, later[0][0] - time.monotonic()) if later else None
            try:
                call = self._calls.get(timeout=timeout_s)
            except queue.Empty:
                self._do(heapq.heappop(later)[2])
                continue
            if call is None:
                return
            at_s, do = call
            if at_s > time.monotonic():
                heapq.heappush(later, (at_s, next(numbers), do))
            else:
                self._do(do)

    @staticmethod
    def _do(do: Callable[[], object]) -> None:
        try:
            do()
        except Exception:  # the user's code may raise any exception; concurrent.futures logs them, too
            LOG.exception("A callback failed.")

    def close(self) -> None:
        """Run the calls that are due and end the thread; all other calls are dropped."""
        with self._lock:
            self._closed = True
            thread = self._thread
        self._calls.put(None)
        if thread is not None and thread is not threading.current_thread():
            thread.join(timeout=2.0)
