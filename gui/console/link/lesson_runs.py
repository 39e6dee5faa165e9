"""`beatrix lesson` as child processes of the window: start a lesson, give a hint, and check at each save."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import msgspec

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lessons import progress
from beatrix_zenoh.processes import POLL_S, Child, Supervisor
from gui.console.link.jobs import Jobs, Repeated
from gui.console.state.actions import RunLesson
from gui.console.state.lesson_strip import known
from gui.console.state.world import CheckReport, LessonRun

ANSWER_S: Final = 30.0
"""Time limit of a start or a hint; a busy computer may need several seconds to start Python."""
READ_S: Final = 3.0
"""Period of reading which lessons have passed."""
END_S: Final = 1.5
"""Time (s) in which the child ends."""


class LessonRuns:
    """Runs one `lesson watch` at a time; all methods return at once."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self.newest = LessonRun()
        """what is known now"""
        self._reads = Repeated(jobs, "lessons", READ_S)
        self._lock = threading.Lock()
        self._wanted = 0
        """counts the watches, and their ends"""

    def look(self, now_s: float) -> None:
        """Read from time to time which lessons were started and passed, perhaps in a terminal."""
        self._reads.look(now_s, self._read)

    def do(self, action: RunLesson) -> None:
        """Run a verb of `beatrix lesson`; a newer watch ends the older one."""
        if action.verb == "watch":
            self._wanted += 1
            wanted = self._wanted
            self._jobs.put("lesson-watch", lambda: self._watch(action.number, wanted))
        elif action.verb == "end":
            self.end()
        else:
            self._jobs.put("lessons", lambda: self._perform(action))

    def end(self) -> None:
        """End the check, because STOP was pressed or the window closes."""
        self._wanted += 1

    def _change(self, **values: Any) -> None:
        with self._lock:  # a hint comes while a check runs
            self.newest = replace(self.newest, **values)

    def _read(self) -> None:
        try:
            found = progress.workspace(Path.cwd())
        except BeatrixError as error:
            self._change(note=str(error))
            return
        names = [one.name for one in known("en")]
        programs = {name: str(paths[0]) for name in names if (paths := found.programs(name))}
        passed = frozenset(name for name in names if found.record(name).passed)
        self._change(passed=passed, programs=programs)

    def _perform(self, action: RunLesson) -> None:
        words = ("--language", action.language) if action.verb == "start" else ()
        with running(action.verb, str(action.number), *words) as child:
            deadline_s = time.monotonic() + ANSWER_S
            while child.code is None and time.monotonic() < deadline_s:
                time.sleep(POLL_S)
            text, good = " ".join(" ".join(child.lines()).split()), child.code == 0
        self._change(note="" if good else text)
        if good and action.verb == "hint":
            self._change(hint=text)
        self._read()

    def _watch(self, number: int, wanted: int) -> None:
        self._change(watched=number, report=CheckReport(outcome="checks"), note="")
        with running("watch", str(number), "--json") as child:
            ended = False
            while not ended and wanted == self._wanted:
                time.sleep(POLL_S)
                ended = child.code is not None
                for line in child.new_lines():
                    with contextlib.suppress(msgspec.DecodeError):  # a note for people
                        self._change(report=msgspec.json.decode(line, type=CheckReport))
        if self.newest.report.outcome == "checks":
            self._change(report=CheckReport())
        self._change(watched=0)
        self._read()


@contextlib.contextmanager
def running(*words: str) -> Iterator[Child]:
    """Run `beatrix lesson` with these arguments; end it at the end of the block."""
    children = Supervisor()
    try:
        yield children.start("lesson", "lesson", *words)
    finally:
        children.end_all(time.monotonic() + END_S)
