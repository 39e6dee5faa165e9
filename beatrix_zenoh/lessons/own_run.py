"""A check without a stage: it judges what a robot that runs already does, for example in a page of a class.

with OwnRun(client, "p01", lesson.about.limit_s) as run:
    while run.look() and program.goes_on():
        ...
found = run.verdict(lesson)
record = keep(lesson, found, program, folder, client.settings)
"""

from __future__ import annotations

import contextlib
import hashlib
import time
from pathlib import Path
from typing import Final, NoReturn, Self

from beatrix_zenoh.client import lesson_reports
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract.errors import NoAnswer, bad_value
from beatrix_zenoh.lesson_files import Lesson
from beatrix_zenoh.lessons import checking, progress, slips
from beatrix_zenoh.lessons.attempt import TAIL_S
from beatrix_zenoh.lessons.checking import Result, Verdict
from beatrix_zenoh.lessons.phrases import Checked, Unmet, busy, phrase
from beatrix_zenoh.lessons.progress import Record, Workspace
from beatrix_zenoh.lessons.stage import RobotWatch, Seen, pace
from beatrix_zenoh.settings import Settings

FIRST_S: Final = 2.0
"""Longest wait (s) for the first position of the robot."""


class OwnRun(Checked):
    """One run of a program with a simulation that runs already: a `with` block observes it.

    Nothing that the block raises is caught: a program that the robot refuses is judged by what it did before.
    """

    def __init__(self, client: Client, robot: str, limit_s: float) -> None:
        """Prepare to observe the simulation of this name; a program that runs for longer than `limit_s` (s) has no end."""
        self._watch, self._limit_s, self._robot = RobotWatch(client, robot), limit_s, robot
        self._began_ns, self._end_s = 0, 0.0
        self.in_time = True
        """whether the program was not ended because of its limit"""

    def __enter__(self) -> Self:
        with contextlib.suppress(NoAnswer):
            self._began_ns = self._watch.first(FIRST_S)
        self._end_s = time.monotonic() + self._limit_s
        return self

    def look(self) -> bool:
        """Keep what was published; return False if the program must end now. To be called every 30 s at least."""
        self._watch.take()
        self.in_time = self.in_time and time.monotonic() < self._end_s
        return self.in_time

    def __exit__(self, *_error: object) -> None:
        time.sleep(TAIL_S)
        self._watch.take()
        self._watch.close()

    def observe(self, **wanted: object) -> Seen:
        """Return what the robot did; see `Attempt.observe` for what is raised."""
        if wanted:
            self.call()
        if not self._began_ns:
            raise busy(phrase("no_positions"))
        seen = self._watch.end(self._began_ns)
        self.panels = self.draw({self._robot: seen})
        if not self.in_time:
            raise Unmet("ends", what=phrase("program"), limit=self._limit_s, **pace({self._robot: seen}))
        self.doubt = seen.doubt
        slips.motions((seen,))
        return seen

    def call(self, *_arguments: object, **_named: object) -> NoReturn:
        """Raise Refused (BAD_VALUE): the check wants more than to observe one run."""
        raise bad_value(
            "This check calls functions of a Python program or needs a simulation of its own, so the lesson does not "
            "suit blocks: take `blocks` out of its lesson.toml.",
        )

    value = call_array = bench = observe_all = on_stage = call

    def verdict(self, lesson: Lesson) -> Verdict:
        """Return what the lesson's check says about this run, in the language of the lesson."""
        return checking.judged(lesson, self, lambda: checking.check_of(lesson)(self))


def keep(
    lesson: Lesson, verdict: Verdict, program: str, folder: Path, settings: Settings | None = None
) -> Record:
    """Count a verdict in the progress of a seat, report it to the router, and return the record of the lesson.

    Args:
        lesson: the lesson.
        verdict: what came of the check.
        program: the program that has run, as text.
        folder: keeps `progress.json` of this seat only.
        settings: those of the seat, whose account reports; None: of this process.

    Raises Refused (BAD_VALUE) if the folder cannot be read or written.
    """
    workspace = Workspace(folder)
    record = workspace.record(lesson.name)
    record.version = lesson.about.version
    sha256 = hashlib.sha256(program.encode()).hexdigest()
    checking.count(record, verdict, progress.sealed(lesson.name, sha256))
    workspace.save()
    measured = verdict.result is not Result.NOT_MEASURABLE
    lesson_reports.report(lesson.name, record.state(measured=measured), settings)
    return record
