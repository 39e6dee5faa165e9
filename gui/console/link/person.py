"""The simulated person: where it is, dragging it, and its voice. The simulation is asked only while that is shown."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs, Repeated
from gui.console.state.actions import MovePerson
from gui.console.state.world import Person

PERIOD_S: Final = 0.1
"""Time between two questions where the person is."""
SPEECH_S, AGAIN_S = 5.0, 3.5
"""Duration of the voice, and when it is asked for again: it ends even if this program is killed."""


class SimulatedPerson:
    """Asks, moves and lets speak the person of the shown simulation, in a queue of its own; no method waits for it."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._robot: Robot | None = None
        self._watched = self._speaks = False
        self._asks = Repeated(jobs, "person", PERIOD_S)
        self._said_s = -math.inf
        """when the voice began (monotonic clock, s)"""
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
        self._robot = robot = session.twin.sim
        if self._watched or self._speaks:
            self._asks.look(now_s, lambda: suppressed(self._ask, robot))

    def move(self, goal: MovePerson) -> None:
        """Move the person; it is shown there at once."""
        self.moves += 1
        self._place = goal.x, goal.y, goal.z
        self._put(lambda robot: robot.move_target(goal.x, goal.y, goal.z))

    def speak(self, *, on: bool) -> None:
        """Let the person speak until it must be silent."""
        was, self._speaks, self._said_s = self._speaks, on, -math.inf
        if was and not on:
            self._put(lambda robot: robot.play_sound("silence"))

    def _put(self, request: Callable[[Robot], object]) -> None:
        """Queue a request; one that fails changes nothing, and the next answer shows where the person is."""
        if (robot := self._robot) is not None:
            self._jobs.put("person", lambda: suppressed(request, robot))

    def _ask(self, robot: Robot) -> None:
        moves, found = self.moves, robot.target()
        if moves == self.moves:  # otherwise the answer is older than the present place
            self._place = found.x, found.y, found.z
        if self._speaks and time.monotonic() > self._said_s + AGAIN_S:
            self._said_s = time.monotonic()
            robot.place_sound()
            robot.play_sound("voice", SPEECH_S)


def suppressed(request: Callable[[Robot], object], robot: Robot) -> None:
    """Make a request, even if it fails."""
    with contextlib.suppress(BeatrixError):
        request(robot)
