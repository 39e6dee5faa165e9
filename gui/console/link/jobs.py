"""The executor of the link: it runs jobs that may wait for router, robots or processes."""

from __future__ import annotations

import math
import queue
import threading
import time
from collections.abc import Callable

from beatrix_zenoh import threads

Job = Callable[[], None]


class Jobs:
    """Runs the jobs of one queue one after the other, and those of several queues at the same time.

    A queue has a thread from its first job on. The threads are daemons, unlike those of `concurrent.futures`: a request
    without an answer does not keep the process of a closed window.
    """

    def __init__(self, name: str) -> None:
        """Start no thread yet; `name` is the beginning of their names."""
        self._name = name
        self._lock = threading.Lock()
        self._queues: dict[str, queue.SimpleQueue[Job | None]] = {}
        """None ends the thread of a queue"""
        self._threads: list[threading.Thread] = []
        self._closed = False

    def put(self, name: str, job: Job) -> None:
        """Add a job to the queue of this name; returns at once, and does nothing after `close`."""
        with self._lock:
            if self._closed:
                return
            if name not in self._queues:
                jobs = self._queues[name] = queue.SimpleQueue()
                self._threads.append(threads.start(lambda: serve(jobs), f"{self._name}-{name}"))
            self._queues[name].put(job)

    def close(self) -> None:
        """End the threads after the queued jobs; returns at once."""
        with self._lock:
            self._closed = True
            for jobs in self._queues.values():
                jobs.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads until `deadline_s` (monotonic clock, s)."""
        for thread in self._threads:
            thread.join(max(0.0, deadline_s - time.monotonic()))


class Repeated:
    """A job that runs again a period after its last end."""

    def __init__(self, jobs: Jobs, queue: str, period_s: float) -> None:
        """Run it in this queue; the first time at once."""
        self._jobs, self._queue, self.period_s = jobs, queue, period_s
        self._due_s = 0.0
        """when it is due (monotonic clock, s); infinite while it waits or runs"""

    def look(self, now_s: float, job: Job) -> None:
        """Put the job into its queue if it is due; returns at once. Call it in one thread only."""
        if now_s >= self._due_s:
            self._due_s = math.inf
            self._jobs.put(self._queue, lambda: self._run(job))

    def _run(self, job: Job) -> None:
        try:
            job()
        finally:
            self._due_s = time.monotonic() + self.period_s


def serve(jobs: queue.SimpleQueue[Job | None]) -> None:
    """Run jobs until None comes."""
    while (job := jobs.get()) is not None:
        try:
            job()
        except Exception as error:  # noqa: BLE001  # the thread must serve later jobs, too
            threads.show_error(error)
