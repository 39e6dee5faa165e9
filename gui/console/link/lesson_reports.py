"""Reports of lessons, which the teacher's link reads again and again while the page of the class is shown."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.client import BeatrixError
from beatrix_zenoh.client.lesson_reports import Row, read
from gui.console.link.connection import Session

PERIOD_S: Final = 5.0


class LessonReports:
    """Reads the reports on a thread that runs only while they are watched; `watch` is called in one thread only."""

    def __init__(self, session: Callable[[], Session | None]) -> None:
        """Store the argument: `session` returns the present session, or None."""
        self._session = session
        self._end = threading.Event()
        self._thread: threading.Thread | None = None
        self.rows: tuple[Row, ...] | None = None
        """the newest reports by seat and lesson; None: none were read yet"""
        self.failed = False
        """whether the last read failed, so that `rows` may be old"""

    def watch(self, *, on: bool) -> None:
        """Begin or end reading; returns at once."""
        self._end.set()
        self.rows, self.failed = None, False
        if on:
            end = self._end = threading.Event()
            self._thread = threads.start(lambda: self._run(end), "window-lessons")

    def _run(self, end: threading.Event) -> None:
        while not end.is_set():
            session = self._session()
            if session is not None:
                self._read(session, end)
            end.wait(PERIOD_S if session is not None else PERIOD_S / 10)

    def _read(self, session: Session, end: threading.Event) -> None:
        try:
            rows = tuple(read(session.client))
        except BeatrixError:
            self.failed = not end.is_set()
        else:
            if not end.is_set():
                self.rows, self.failed = rows, False

    def close(self) -> None:
        """End reading; returns at once."""
        self._end.set()

    def join(self, deadline_s: float) -> None:
        """Wait for the end of the thread until `deadline_s` (monotonic clock, s)."""
        if self._thread is not None:
            self._thread.join(max(0.0, deadline_s - time.monotonic()))
