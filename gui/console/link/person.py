"""The simulated person: where it is, dragging it, and its voice. The simulation is asked only while that is shown."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Iterator
from typing import Final

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs
from gui.console.state.actions import MovePerson
from gui.console.state.world import Person

PERIOD_S: Final = 0.1
"""Time between two questions where the person is."""
SPEECH_S: Final = 5.0
"""Duration of the voice, which is asked for again and again: it ends even if this program is killed."""
AGAIN_S: Final = 3.5


class SimulatedPerson:
    """Asks, moves and lets speak the person of the shown simulation, in a queue of its own; no method waits for it."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._robot: Robot | None = None
        self._watched = self._speaks = False
        self._goal: MovePerson | None = None
        """where the user has dragged the person, until that is sent"""
        self._due_s = self._said_s = -math.inf
        """when to ask again, infinite while a question is under way; when the voice began (monotonic clock, s)"""
        self._place: tuple[float, float, float] | None = None
        self.moves = 0
        """how often the user has moved the person"""

    @property
    def newest(self) -> Person | None:
        """The person; None: not known, or not asked for."""
        place = self._place
        return Person(*place, speaks=self._speaks) if place is not None and self._watched else None

    def watch(self, *, on: bool) -> None:
        """Begin or end asking."""
        self._watched = on

    def look(self, session: Session | None, now_s: float) -> None:
        """Ask again if it is time; call it in one thread only."""
        if session is None or (session.twin.name, "sim") not in session.monitor.present():
            self._robot, self._place, self._speaks = None, None, False
            return
        robot = self._robot = session.twin.sim
        if (self._watched or self._speaks) and now_s >= self._due_s:
            self._due_s = math.inf
            self._jobs.put("person", lambda: self._ask(robot))

    def move(self, goal: MovePerson) -> None:
        """Move the person; of several places only the newest is sent."""
        self._goal, self.moves = goal, self.moves + 1
        self._place = goal.x, goal.y, goal.z  # shown at once
        if (robot := self._robot) is not None:
            self._jobs.put("person", lambda: self._go(robot))

    def speak(self, *, on: bool) -> None:
        """Let the person speak until it must be silent."""
        was, self._speaks = self._speaks, on
        if was and not on and (robot := self._robot) is not None:
            self._jobs.put("person", lambda: self._be_silent(robot))

    @contextlib.contextmanager
    def speaking(self) -> Iterator[None]:
        """Let the person speak during the block."""
        self.speak(on=True)
        try:
            yield
        finally:
            self.speak(on=False)

    def _ask(self, robot: Robot) -> None:
        try:
            found = robot.target()
            if self._goal is None:
                self._place = found.x, found.y, found.z
            if self._speaks and time.monotonic() > self._said_s + AGAIN_S:
                robot.place_sound()
                robot.play_sound("voice", SPEECH_S)
                self._said_s = time.monotonic()
        except BeatrixError:
            self._place = None
        finally:
            self._due_s = time.monotonic() + PERIOD_S

    def _go(self, robot: Robot) -> None:
        goal, self._goal = self._goal, None
        if goal is not None:
            with contextlib.suppress(BeatrixError):  # the next answer shows where the person is
                robot.move_target(goal.x, goal.y, goal.z)

    def _be_silent(self, robot: Robot) -> None:
        self._said_s = -math.inf
        with contextlib.suppress(BeatrixError):  # the voice ends by itself
            robot.play_sound("silence")
