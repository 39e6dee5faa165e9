"""The class: states of all robots and reports of lessons for its page, and lease queries of the teacher."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.client import BeatrixError, Presence, RobotState
from beatrix_zenoh.client.lease import govern, pending
from beatrix_zenoh.client.lesson_reports import Row, read
from beatrix_zenoh.contract._generated.messages import LeaseQuery
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import of_several
from gui.console.state.actions import Govern, Outcome

STATES_S: Final = 0.2
"""Period of reading all states: decoding 60 of them takes milliseconds, too long for each refresh of the window."""
REPORTS_S: Final = 5.0
"""Period of reading the reports."""


class ClassStates:
    """The states of all robots online, read only while they are shown; used in Qt's thread only."""

    def __init__(self) -> None:
        self._watched = False
        self._read_s = 0.0
        self._states: tuple[RobotState, ...] = ()

    def watch(self, *, on: bool) -> None:
        """Begin or end reading."""
        self._watched, self._read_s, self._states = on, 0.0, ()

    def states(self, session: Session | None, now_s: float) -> tuple[RobotState, ...]:
        """Return the states, at most STATES_S old, by name, the simulation first; empty unless watched."""
        if session is None or not self._watched:
            return ()
        if now_s - self._read_s >= STATES_S:
            found = session.monitor.robots()
            self._states = tuple(robot for robot in found if robot.presence is not Presence.ABSENT)
            self._read_s = now_s
        return self._states


def send_govern(action: Govern, session: Session, report: Callable[[Outcome], None]) -> None:
    """Send a lease query to several robots at the same time; report one outcome when they have answered."""
    places = action.places or tuple(sorted(session.monitor.present()))
    query = LeaseQuery(action=action.action, speed=action.speed, seat=action.seat)
    results = dict(govern(session.client, places, query))
    later = {} if action.places else pending(session.client, query)
    failed = {place: found for place, found in results.items() if isinstance(found, BeatrixError)}
    report(of_several(action.row, len(results) or len(later), failed))


class LessonReports:
    """Reads the reports of lessons while they are watched; the methods are called in one thread only."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._watches = 0
        """number of calls of `watch`: a read that began before the last one is ignored"""
        self._due_s = math.inf
        """when to read again (monotonic clock, s); infinite while a read is under way, or nothing is watched"""
        self.rows: tuple[Row, ...] | None = None
        """the newest reports by seat and lesson; None: none were read yet"""
        self.failed = False
        """whether the last read failed, so that `rows` may be old"""

    def watch(self, *, on: bool) -> None:
        """Begin or end reading."""
        self._watches += 1
        self._due_s = 0.0 if on else math.inf
        self.rows, self.failed = None, False

    def look(self, session: Session | None, now_s: float) -> None:
        """Read the reports again if it is time; returns at once."""
        if session is not None and now_s >= self._due_s:
            self._due_s, watches = math.inf, self._watches
            self._jobs.put("lessons", lambda: self._read(session, watches))

    def _read(self, session: Session, watches: int) -> None:
        try:
            rows = tuple(read(session.client))
        except BeatrixError:
            rows = None
        if watches == self._watches:
            self.rows, self.failed = self.rows if rows is None else rows, rows is None
            self._due_s = time.monotonic() + REPORTS_S
