"""A thread that runs jobs one after the other."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable
from typing import Protocol

from beatrix_zenoh import threads


class LinkPart(Protocol):
    """A part of the link that has threads."""

    def close(self) -> None:
        """Ask the threads of this part to end; returns at once."""

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the threads of this part until `deadline_s` (monotonic clock, s)."""


class Worker:
    """A thread for jobs that may wait for router, robots or processes; parts of the link inherit from it."""

    def __init__(self, name: str) -> None:
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threads.start(self._do_jobs, name)

    def put(self, job: Callable[[], None]) -> None:
        """Queue a job; returns at once."""
        self._jobs.put(job)

    def _do_jobs(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                job()
            except Exception as error:  # noqa: BLE001  # the thread must serve later jobs, too
                threads.show_error(error)

    def close(self) -> None:
        """End the thread after the queued jobs; returns at once."""
        self._jobs.put(None)

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the thread until `deadline_s` (monotonic clock, s)."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))
