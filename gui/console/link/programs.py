"""Plays and the program that follows a face: the newest one ends the one before, and begins when that has ended."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import ClassVar

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import accepted, done, failed, replaced
from gui.console.state.actions import Outcome, Play

Report = Callable[[Outcome], None]


class Program(ABC):
    """What moves robots until it ends or must end, from the request to its end."""

    QUEUE: ClassVar[str]
    """queue of the jobs of this class"""
    WAIT_S: ClassVar[float]
    """longest time (s) that a newer motion waits for the end"""

    def __init__(self, row: int, side: str) -> None:
        """Store row and side of the outcomes; without a side they are those of both robots."""
        self.row, self.side = row, side
        self.ends = False
        """whether it must end"""
        self.ending: BeatrixError | None = None
        """why it must end; None: it may go on, or the user has ended it"""
        self.over = threading.Event()
        """set at the end"""

    @abstractmethod
    def perform(self, report: Report) -> str:
        """Report the beginning, do the work until the end, and return the message; ends soon after `ends` is set."""

    def end(self, why: BeatrixError | None) -> None:
        """End it for a reason, unless it must end already; None: the user has ended it. Returns at once."""
        if not self.ends:
            self.ending, self.ends = why, True

    def check(self) -> None:
        """Raise `ending` if there is one."""
        if self.ending is not None:
            raise self.ending

    def wait_ended(self) -> None:
        """Wait for the end, at most WAIT_S."""
        self.over.wait(self.WAIT_S)


class Programs:
    """Runs the newest program."""

    def __init__(self, jobs: Jobs, report: Report, clear: Callable[[], None]) -> None:
        """Store the arguments; `clear` ends other motions before a program begins."""
        self._jobs, self._report, self._clear = jobs, report, clear
        self._lock = threading.Lock()
        self.newest: Program | None = None
        """the newest program, until its end"""

    def begin(self, program: Program) -> None:
        """Begin a program, which replaces the present one; returns at once."""
        with self._lock:
            before, self.newest = self.newest, program
        if before is not None:
            before.end(replaced())
        self._jobs.put(program.QUEUE, lambda: self._run(program, before))

    def end(self, why: BeatrixError) -> None:
        """End the present program; returns at once."""
        if (program := self.newest) is not None:
            program.end(why)

    def wait_ended(self) -> None:
        """Wait for the end of the present program, at most its WAIT_S."""
        if (program := self.newest) is not None:
            program.wait_ended()

    def _run(self, program: Program, before: Program | None) -> None:
        began_s = time.monotonic()
        try:
            if before is not None:
                before.wait_ended()
            program.check()
            self._clear()
            message = program.perform(self._report)
            outcome = done(program.row, program.side, message, time.monotonic() - began_s)
        except BeatrixError as error:
            outcome = failed(program.row, program.side, error)
        finally:
            with self._lock:
                if self.newest is program:
                    self.newest = None
            program.over.set()
        self._report(outcome)


class Playing(Program):
    """One play."""

    QUEUE, WAIT_S = "play", 1.0

    def __init__(self, action: Play, robots: Twin | Robot) -> None:
        """Store the arguments."""
        super().__init__(action.row, "" if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self.title = action, robots, action.title
        self.pose = -1
        """number of the pose of the window that began last, from 0; -1: none"""

    def perform(self, report: Report) -> str:
        """Check all of the play, then play it."""
        from gui.console.link.choreographies import prepared  # noqa: PLC0415  # numpy and the planner would delay the window

        def begun(rounds: int = 0) -> None:
            told = accepted(self.row, self.side, f"{self.title}: checked.", lasts_s)
            report(replace(told, rounds=rounds))

        def posed(number: int) -> None:
            if self._action.poses:
                self.pose = number

        lasts_s, play = prepared(self._action, self._robots, self.check, begun, posed)
        self.check()
        begun()
        play()
        return f"{self.title}: played."
