"""The class: states of all robots and reports of lessons for its page, and lease queries of the teacher."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from beatrix_zenoh.client import BeatrixError, Presence, RobotState
from beatrix_zenoh.client.lease import govern, pending, refused
from beatrix_zenoh.client.lesson_reports import Row, read
from beatrix_zenoh.contract._generated.messages import LeaseQuery
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs, Repeated
from gui.console.link.outcomes import of_several
from gui.console.state.actions import Govern, Outcome

REPORTS_S: Final = 5.0
"""Period of reading the reports."""


def robots_online(session: Session | None) -> tuple[RobotState, ...]:
    """Return the states of all robots online, by name, the simulation first."""
    found = [] if session is None else session.monitor.robots()
    return tuple(robot for robot in found if robot.presence is not Presence.ABSENT)


def send_govern(action: Govern, session: Session, report: Callable[[Outcome], None]) -> None:
    """Send a lease query to several robots at the same time; report one outcome when they have answered."""
    places = action.places or tuple(sorted(session.monitor.present()))
    query = LeaseQuery(action=action.action, speed=action.speed, seat=action.seat)
    results = dict(govern(session.client, places, query))
    later = {} if action.places or refused(session.client, results) else pending(session.client, query)
    failed = {place: found for place, found in results.items() if isinstance(found, BeatrixError)}
    report(of_several(action.row, len(results) or len(later), failed))


class LessonReports:
    """Reads the reports of lessons while they are watched; the methods are called in one thread only."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs, self.watched = jobs, True
        self.watch(on=False)

    def watch(self, *, on: bool) -> None:
        """Begin or end reading."""
        if on is self.watched:
            return
        self.watched, self._reads = on, Repeated(self._jobs, "lessons", REPORTS_S)
        self.rows: tuple[Row, ...] | None = None
        """the newest reports by seat and lesson; None: none were read yet"""
        self.failed = False
        """whether the last read failed, so that `rows` may be old"""

    def look(self, session: Session | None, now_s: float) -> None:
        """Read the reports again if it is time; returns at once."""
        if self.watched and session is not None:
            self._reads.look(now_s, lambda: self._read(session))

    def _read(self, session: Session) -> None:
        rows, failed = self.rows, False
        try:
            rows = tuple(read(session.client))
        except BeatrixError:
            failed = True
        if self.watched:
            self.rows, self.failed = rows, failed
