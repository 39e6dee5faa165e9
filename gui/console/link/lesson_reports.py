"""Reports of lessons, which the teacher's link reads again and again while the page of the class is shown."""

from __future__ import annotations

import math
import time
from typing import Final

from beatrix_zenoh.client import BeatrixError
from beatrix_zenoh.client.lesson_reports import Row, read
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs

PERIOD_S: Final = 5.0


class LessonReports:
    """Reads the reports while they are watched; the methods are called in one thread only."""

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
            self._due_s = time.monotonic() + PERIOD_S
