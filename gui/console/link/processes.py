"""Child processes that end within the time limit for closing the window."""

from __future__ import annotations

import threading
import time

from beatrix_zenoh import threads
from beatrix_zenoh.cli.processes import Child, Role, Supervisor
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused

KILL_S = 0.4
"""Time to kill children that do not end, and to delete the folder of their output."""


class Processes(Supervisor):
    """A supervisor that one thread can end, even while another thread waits for a child."""

    def __init__(self) -> None:
        super().__init__()
        self._starting = threading.Lock()
        self._closed = False

    def start(self, title: str, *arguments: str, role: Role = Role.REQUIRED) -> Child:
        """Start a process as `Supervisor.start` does; raises Refused (SHUTDOWN) after `end_all`."""
        with self._starting:
            if self._closed:
                raise Refused(Reason.SHUTDOWN, "The window was closed.")
            return super().start(title, *arguments, role=role)

    def forget_ended(self) -> None:
        """Remove the children that have ended."""
        for child in list(self.children):
            if child.code is not None:
                self.finish(child)

    def failure(self) -> str:
        """Return a sentence with the exit code and last lines of a child that has ended; empty if all run."""
        try:
            self.check()
        except Refused as refusal:
            return refusal.message
        return ""

    def end_all(self, deadline_s: float) -> None:
        """End all children at the same time.

        Those that still run shortly before `deadline_s` (monotonic clock, s) are killed.
        """
        with self._starting:
            self._closed = True
        grace_s = max(0.0, deadline_s - KILL_S - time.monotonic())
        ending = [
            threads.start(lambda child=child: child.end(grace_s), f"end-{child.title}")  # type: ignore[misc]
            for child in list(self.children)
        ]
        for thread in ending:
            thread.join()
        self.end()
