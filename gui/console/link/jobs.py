"""The executor of the link: it runs jobs that may wait for router, robots or processes."""

from __future__ import annotations

import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads

THREADS: Final = 4
"""Threads that a link needs without a press: for the connection, levels and the clocks of two robots."""
Job = Callable[[], None]


class Jobs:
    """Runs the jobs of one queue one after the other, and those of several queues at the same time.

    A queue exists while it has jobs, and there are as many threads as there were ever queues at the same time, at least
    THREADS. The threads are daemons, unlike those of `concurrent.futures`: a request without an answer does not keep the
    process of a closed window.
    """

    def __init__(self, name: str) -> None:
        """Start THREADS threads; `name` is the beginning of their names."""
        self._name = name
        self._lock = threading.Lock()
        self._queues: dict[str, deque[Job]] = {}
        """jobs that wait, for each queue with a job that runs or waits"""
        self._ready: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        """queues that wait for a thread; None ends a thread"""
        self._threads: list[threading.Thread] = []
        self._closed = False
        for _ in range(THREADS):
            self._start()

    def put(self, name: str, job: Job) -> None:
        """Add a job to the queue of this name; returns at once, and does nothing after `close`."""
        with self._lock:
            if self._closed:
                return
            if name in self._queues:
                self._queues[name].append(job)
                return
            self._queues[name] = deque([job])
            if len(self._queues) > len(self._threads):
                self._start()
        self._ready.put(name)  # without the lock, which the thread takes at once

    def _start(self) -> None:
        self._threads.append(threads.start(self._serve, f"{self._name}-{len(self._threads) + 1}"))

    def _serve(self) -> None:
        while (name := self._ready.get()) is not None:
            while (job := self._next(name)) is not None:
                try:
                    job()
                except Exception as error:  # noqa: BLE001  # the thread must serve later jobs, too
                    threads.show_error(error)

    def _next(self, name: str) -> Job | None:
        """Return the next job of a queue; without one remove the queue and return None."""
        with self._lock:
            if self._queues[name]:
                return self._queues[name].popleft()
            del self._queues[name]
            return None

    def close(self) -> None:
        """End the threads after the queued jobs; returns at once."""
        with self._lock:
            self._closed = True
            for _ in self._threads:
                self._ready.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads until `deadline_s` (monotonic clock, s)."""
        for thread in self._threads:
            thread.join(max(0.0, deadline_s - time.monotonic()))
