"""Recordings: the recorder is a child process, which writes into `recordings/`."""

from __future__ import annotations

import os
import threading
import time
from datetime import datetime
from pathlib import Path

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import exit_code
from beatrix_zenoh.processes import POLL_S, READY_S, Child, Supervisor
from gui.console.link.worker import Worker
from gui.console.state.world import RecordingProgress

FOLDER = "recordings"
NO_ROBOT = exit_code(Reason.NO_ANSWER)
"""Exit code of a recorder that has received nothing from a robot."""


class Recordings(Worker):
    """Runs one recorder at a time, on a thread of its own; methods except `join` return at once."""

    def __init__(self) -> None:
        super().__init__("window-recorder")
        self._lock = threading.Lock()
        self._file: Path | None = None
        self._processes: Supervisor | None = None
        self._child: Child | None = None
        self._began_s: float | None = None
        self._lasted_s: float | None = None
        """duration (s); None: the recording runs"""
        self._trouble = ""
        self._ending = False
        """whether the user has ended the recording"""

    def progress(self) -> RecordingProgress | None:
        """Return the progress of the last recording; None if there was none."""
        file, child = self._file, self._child
        if file is None:
            return None
        if self._lasted_s is None and child is not None:
            if self._began_s is None and child.ready:
                self._began_s = time.monotonic()
            if child.code is not None:
                self._ended()
        seconds = self._lasted_s
        if seconds is None:
            seconds = 0.0 if self._began_s is None else time.monotonic() - self._began_s
        running = self._lasted_s is None
        return RecordingProgress(file, running, seconds, self._trouble, ending=running and self._ending)

    def begin(self, robot: str, endpoint: str) -> None:
        """Record the robots of this name until `end`; does nothing while a recording runs."""
        with self._lock:
            if self._file is not None and self._lasted_s is None:
                return
            self._child = self._began_s = self._lasted_s = None
            self._trouble, self._ending = "", False
            stamp = f"{datetime.now().astimezone():%Y-%m-%d-%H%M%S}"
            file = self._file = folder() / f"{robot}-{stamp}.rrd"
        self.put(lambda: self._begin(file, robot, endpoint))

    def _begin(self, file: Path, robot: str, endpoint: str) -> None:
        words = ("record", str(file), "--name", robot, "--connect", endpoint)
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            processes = self._processes = self._processes or Supervisor()
            processes.forget_ended()
            self._child = processes.start("recorder", *words)
        except OSError as error:
            self._trouble, self._lasted_s = f"The recording cannot begin: {error}.", 0.0
        except BeatrixError as error:
            self._trouble, self._lasted_s = error.message, 0.0

    def end(self) -> None:
        """End the recording; its file is complete once `progress` reports that it no longer runs."""
        self._ending = True
        self.put(self._end)

    def _end(self) -> None:
        child = self._child
        if child is not None and self._lasted_s is None:
            deadline_s = time.monotonic() + READY_S
            while not child.ready and child.code is None and time.monotonic() < deadline_s:
                time.sleep(POLL_S)  # a recorder that ends while it starts would leave no file
            child.end()
            self._ended()

    def _ended(self) -> None:
        """Store the duration and, if the recorder failed, the reason."""
        child, processes = self._child, self._processes
        with self._lock:
            if self._lasted_s is None:
                self._lasted_s = 0.0 if self._began_s is None else time.monotonic() - self._began_s
                # A recording that the user ends while it is starting is empty, which is not a failure.
                accepted = (0, NO_ROBOT) if self._ending else (0,)
                if child is not None and processes is not None and child.code not in accepted:
                    self._trouble = processes.failure()

    def join(self, deadline_s: float) -> None:
        """End the recording; wait for its end until `deadline_s` (monotonic clock, s) at the latest."""
        if self._processes is not None:
            self._processes.end_all(deadline_s)
        super().join(deadline_s)


def folder() -> Path:
    """Return `recordings/` in the working directory, or in the user's Documents if the former is read-only."""
    here = Path.cwd()
    root = here if os.access(here, os.W_OK) else Path.home() / "Documents"
    return root / FOLDER
