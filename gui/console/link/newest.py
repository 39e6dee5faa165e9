"""The newest of several jobs that must not run beside each other."""

from __future__ import annotations

import threading
from typing import Generic, Protocol, TypeVar

from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.outcomes import replaced


class Job(Protocol):
    """A job that ends soon after `ending` is set."""

    ending: BeatrixError | None
    """why the job must end; None: it may go on"""


J = TypeVar("J", bound=Job)


class Newest(Generic[J]):
    """Replaces the job before by the newest one; other threads can wait until no job is left."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.job: J | None = None
        """the newest job, until its end"""
        self._idle = threading.Event()
        self._idle.set()

    def begin(self, job: J) -> None:
        """Make this the newest job; the one before must end."""
        with self._lock:
            if self.job is not None:
                self.job.ending = replaced()
            self.job = job
            self._idle.clear()

    def finish(self, job: J) -> None:
        """Record the end of a job."""
        with self._lock:
            if self.job is job:
                self.job = None
                self._idle.set()

    def wait_ended(self, timeout_s: float) -> bool:
        """Wait for the end of the newest job; return False on timeout."""
        return self._idle.wait(timeout_s)
