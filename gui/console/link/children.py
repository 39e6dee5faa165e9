"""Simulation, router, viewer and recorder as child processes, which end with the window."""

from __future__ import annotations

import math
import os
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.output import exit_code
from beatrix_zenoh.processes import POLL_S, PYTHON, Child, Supervisor, in_words, start_router
from gui.console.link.jobs import Jobs
from gui.console.state.world import RecordingProgress, Trouble, UsbPort

FOLDER = "recordings"
NO_ROBOT = exit_code(Reason.NO_ANSWER)
"""Exit code of a recorder that has received nothing from a robot."""
SIMULATION, HARDWARE = "simulation", "hardware"
"""Titles of the nodes."""
ENDED = {word: f"trouble.{word}" for word in ("router", SIMULATION, HARDWARE, "viewer", "recorder")}
"""Texts by the title of a child."""
WATCH_S: Final = 0.1
"""Period in which a recorder is watched."""
LIST_S: Final = 15.0
"""Time limit of the child; a busy computer may need several seconds to start Python."""


class Children:
    """Starts child processes one after the other; methods except `end_all` return at once."""

    def __init__(self, jobs: Jobs, started: Callable[[], None]) -> None:
        """Start no process yet; `started` is called when the router runs."""
        self._jobs, self._started = jobs, started
        self._serving, self._viewers = Supervisor(), Supervisor()
        """Router, simulation and hardware; viewers of recordings."""
        self._nodes: dict[str, Child] = {}
        """The newest simulation and hardware, by SIMULATION and HARDWARE."""
        self._starting: set[str] = set()
        self._trouble: Trouble | None = None

    def starts(self, title: str) -> bool:
        """Return whether a requested SIMULATION or HARDWARE is still starting."""
        return title in self._starting

    def runs(self, title: str) -> bool:
        """Return whether a SIMULATION or HARDWARE of this window is running."""
        node = self._nodes.get(title)
        return node is not None and node.code is None

    @property
    def trouble(self) -> Trouble | None:
        """The reason why a child process did not start or has failed; None if there is none."""
        for processes in (self._serving, self._viewers):
            failed = any(child.code not in (None, 0) for child in list(processes.children))
            if failed and not (self._trouble or self._starting):
                self._trouble = ended(processes)
                processes.forget_ended()  # so that each failure is reported once
        return self._trouble

    def simulate(self, robot: str, endpoint: str) -> None:
        """Start a simulation, ready to move, and a router if none answers."""
        self._start(SIMULATION, endpoint, "sim", "--name", robot, "--ready")

    def connect(self, robot: str, endpoint: str, port: str) -> None:
        """Start the hardware at a port instead of that of this window, and a router if none answers."""
        self._start(HARDWARE, endpoint, "hw", "--name", robot, "--port", port)

    def _start(self, title: str, endpoint: str, *words: str) -> None:
        self._starting.add(title)
        self._trouble = None

        def start() -> None:
            try:
                self._nodes[title] = self._serve(endpoint, title, *words)
            except (BeatrixError, OSError) as error:
                self._trouble = self._trouble or not_started(error)
            finally:
                self._starting.discard(title)

        self._jobs.put("children", start)

    def _serve(self, endpoint: str, title: str, *words: str) -> Child:
        """Start router and node and wait until they serve; raises Refused, NoAnswer or OSError."""
        serving = self._serving
        serving.forget_ended()
        if (before := self._nodes.get(title)) in serving.children:
            serving.finish(before)  # two nodes of one name are refused
        try:
            start_router(serving, endpoint)
            self._started()
            child = serving.start(title, *words, "--connect", endpoint)
            serving.wait_ready()
        except BeatrixError:
            self._trouble = ended(serving)
            serving.forget_ended()  # so that `trouble` does not report the same failure again
            raise
        return child

    def view(self, file: Path) -> None:
        """Start a new viewer process that shows a recording."""
        self._trouble = None
        self._jobs.put("children", lambda: self._view(file))

    def _view(self, file: Path) -> None:
        try:
            self._viewers.forget_ended()
            self._viewers.start("viewer", "view", str(file))
        except (BeatrixError, OSError) as error:
            self._trouble = not_started(error)

    def end_all(self, deadline_s: float) -> None:
        """End all children by `deadline_s` (monotonic clock, s)."""
        for processes in (self._viewers, self._serving):
            processes.end_all(deadline_s)


class Recordings:
    """Runs one recorder at a time; methods except `end_all` return at once. One thread calls them, for a window Qt's."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._newest: RecordingProgress | None = None
        self._processes = Supervisor()
        self._began_s = math.inf
        """when the recorder was ready (monotonic clock, s)"""
        self._end = threading.Event()
        """set when the user ends the recording"""

    def progress(self) -> RecordingProgress | None:
        """Return the progress of the last recording; None if there was none."""
        newest = self._newest
        if newest is None or not newest.running:
            return newest
        return replace(newest, seconds=self._seconds(), ending=self._end.is_set())

    def _seconds(self) -> float:
        return max(0.0, time.monotonic() - self._began_s)

    def begin(self, robot: str, endpoint: str) -> None:
        """Record the robots of this name until `end`; does nothing while a recording runs."""
        if self._newest is not None and self._newest.running:
            return
        self._end.clear()
        self._began_s = math.inf
        file = folder() / f"{robot}-{datetime.now().astimezone():%Y-%m-%d-%H%M%S}.rrd"
        self._newest = RecordingProgress(file, running=True, seconds=0.0)
        words = ("record", str(file), "--name", robot, "--connect", endpoint)
        self._jobs.put("recorder", lambda: self._record(file, words))

    def end(self) -> None:
        """End the recording; its file is complete once `progress` reports that it no longer runs."""
        self._end.set()

    def _record(self, file: Path, words: Sequence[str]) -> None:
        """Run a recorder until the user ends it, or it ends by itself."""
        trouble = None
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            self._processes.forget_ended()
            child = self._processes.start("recorder", *words)
            while child.code is None and not child.ready:
                time.sleep(POLL_S)  # a recorder that ends while it starts would leave no file
            self._began_s = time.monotonic()
            while child.code is None and not self._end.wait(WATCH_S):
                pass
            child.end()
            # A recording that the user ends while it is starting is empty, which is not a failure.
            if child.code not in ((0, NO_ROBOT) if self._end.is_set() else (0,)):
                trouble = ended(self._processes)
        except (BeatrixError, OSError) as error:
            trouble = not_started(error)
        self._newest = RecordingProgress(file, running=False, seconds=self._seconds(), trouble=trouble)

    def end_all(self, deadline_s: float) -> None:
        """End the recording; wait for its end until `deadline_s` (monotonic clock, s) at the latest."""
        self._processes.end_all(deadline_s)


def ended(processes: Supervisor) -> Trouble | None:
    """Return which child of a supervisor has ended, and its output; None if all run."""
    for child in processes.children:
        if child.code is not None:
            code = in_words(child.code).removeprefix("exit code ")
            return Trouble(ENDED[child.title], code, processes.output_of(child))
    return None


def not_started(error: BeatrixError | OSError) -> Trouble:
    """Return why a child was not started."""
    if isinstance(error, OSError):
        return Trouble("trouble.start", detail=str(error))
    key = "trouble.elsewhere" if error.reason is Reason.NO_ROUTER else "trouble.start"
    return Trouble(key, detail=error.message)


def folder(name: str = FOLDER) -> Path:
    """Return `recordings/`, or another folder, in the working directory, or in Documents if the former is read-only."""
    here = Path.cwd()
    root = here if os.access(here, os.W_OK) else Path.home() / "Documents"
    return root / name


class Ports:
    """Lists the ports."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self.newest: tuple[UsbPort, ...] | None = None
        """the ports found last; None: not known yet"""

    def look(self) -> None:
        """List the ports anew; returns at once."""
        self.newest = None
        self._jobs.put("ports", self._look)

    def _look(self) -> None:
        command = [*PYTHON, "beatrix_zenoh.cli", "hw", "--ports"]
        try:
            # Its own standard input may be a pipe that another thread reads: on Windows a child would wait for that.
            output = subprocess.check_output(
                command, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, encoding="utf-8", timeout=LIST_S
            )
            self.newest = parsed(output.splitlines())
        except (OSError, ValueError, subprocess.SubprocessError):
            self.newest = ()


def parsed(lines: list[str]) -> tuple[UsbPort, ...]:
    """Return the ports of the output of `beatrix hw --ports`, boards first."""
    rows = [line.split("\t") for line in lines if line.count("\t") == 2]
    ports = [UsbPort(device, title, board=kind == "board") for kind, device, title in rows]
    return tuple(sorted(ports, key=lambda port: not port.board))
