"""Simulation, router and viewer as child processes, which end with the window."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.processes import Child, Supervisor, start_router
from gui.console.link.worker import Worker


class Children(Worker):
    """Starts child processes on a thread of its own; methods except `join` return at once."""

    def __init__(self, started: Callable[[], None]) -> None:
        """Start the thread but no process; `started` is called when the router runs."""
        super().__init__("window-children")
        self._started = started
        self._serving: Supervisor | None = None
        """Router and simulation."""
        self._viewers: Supervisor | None = None
        self._simulation: Child | None = None
        self._numbers = itertools.count(1)
        self.starting = False
        """whether a requested simulation is still starting"""
        self._trouble = ""

    @property
    def own_simulation(self) -> bool:
        """Whether a simulation of this window is running."""
        simulation = self._simulation
        return simulation is not None and simulation.code is None

    @property
    def trouble(self) -> str:
        """The reason why a child process did not start or has failed; empty if there is none."""
        for processes in (self._serving, self._viewers):
            if self._trouble or self.starting or processes is None:
                continue
            if any(child.code not in (None, 0) for child in list(processes.children)):
                self._trouble = processes.failure()
                processes.forget_ended()  # so that each failure is reported once
        return self._trouble

    def simulate(self, robot: str, endpoint: str) -> None:
        """Start a simulation, ready to move, and a router if none answers."""
        self.starting, self._trouble = True, ""
        self.put(lambda: self._simulate(robot, endpoint))

    def _simulate(self, robot: str, endpoint: str) -> None:
        try:
            self._serve(robot, endpoint)
        except BeatrixError as error:
            self._trouble = error.message
        except OSError as error:
            self._trouble = f"A process cannot be started: {error}."
        finally:
            self.starting = False

    def _serve(self, robot: str, endpoint: str) -> None:
        """Start router and simulation and wait until they serve; raises Refused, NoAnswer or OSError."""
        serving = self._serving = self._serving or Supervisor()
        serving.forget_ended()
        try:
            start_router(serving, endpoint)
            self._started()
            words = ("sim", "--name", robot, "--connect", endpoint, "--ready")
            simulation = serving.start("simulation", *words)
            serving.wait_ready()
        except BeatrixError:
            serving.forget_ended()  # so that `trouble` does not report the same failure again
            raise
        self._simulation = simulation

    def view(self, file: Path) -> None:
        """Start a new viewer process that shows a recording."""
        self._trouble = ""
        self.put(lambda: self._view(file))

    def _view(self, file: Path) -> None:
        try:
            viewers = self._viewers = self._viewers or Supervisor()
            viewers.forget_ended()
            viewers.start(f"viewer-{next(self._numbers)}", "view", str(file))
        except BeatrixError as error:
            self._trouble = error.message
        except OSError as error:
            self._trouble = f"A viewer cannot be started: {error}."

    def join(self, deadline_s: float) -> None:
        """End all children and the thread by `deadline_s` (monotonic clock, s)."""
        for processes in (self._viewers, self._serving):
            if processes is not None:
                processes.end_all(deadline_s)
        super().join(deadline_s)
