"""Lessons of one page: running the blocks is the check, which judges what the page's own simulated head does."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Final, Protocol

import msgspec

from beatrix_zenoh import threads
from beatrix_zenoh.client import Client, lesson_reports
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lesson_files import BlockLesson, block_lessons
from beatrix_zenoh.lessons import own_run
from beatrix_zenoh.lessons.checking import Verdict
from beatrix_zenoh.lessons.own_run import OwnRun
from beatrix_zenoh.lessons.page import lesson_pages, plain
from beatrix_zenoh.lessons.progress import ProgressFile, Workspace
from gui.console.link import Link
from gui.console.link.block_run import BlockRun
from gui.console.state.actions import EndBlocks
from gui.console.state.intents import Intent, RunBlocks
from gui.console.state.state import State
from gui.page.messages import AskHint, CheckProgram

LOOK_S: Final = 0.2
"""Period in which a check keeps what the robot has published."""
BEGIN_S: Final = 5.0
"""Longest time until the server's loop begins a program."""


class Face(Protocol):
    """The page whose lessons these are."""

    robot: str
    state: State

    @property
    def driver(self) -> object | None:
        """What the page has while it drives."""

    @property
    def own_link(self) -> Link | None:
        """The link of its seat."""

    def carry_out(self, intent: Intent) -> None:
        """Carry out an intent."""

    def renew(self) -> None:
        """Let the next view be sent soon."""


class LessonState(msgspec.Struct, frozen=True):
    """What the seat has reached in a lesson."""

    passed: bool
    tries: int
    hints: tuple[str, ...]
    """those that were given"""
    more: int
    """number of hints that were not given yet"""


class CheckView(msgspec.Struct, frozen=True):
    """The last check of a page."""

    lesson: str = ""
    checks: bool = False
    """whether it goes on"""
    result: str = ""
    """`passed`, `not_yet` or `not_measurable`; empty: there is none"""
    asked: str = ""
    found: str = ""
    means: str = ""
    picture: str = ""
    """as SVG; empty: there is none"""


class Lessons:
    """The lessons of one seat; all methods run on the thread of the server's loop, which waits for nothing here."""

    def __init__(self, folder: Path, call: Callable[..., None]) -> None:
        """Read what the seat has done so far.

        Args:
            folder: keeps the progress of this seat only.
            call: runs a function with its arguments on the server's loop; any thread may use it.
        """
        self._folder, self._call = folder, call
        self._progress = ProgressFile()
        self._states: dict[str, dict[str, LessonState]] = {}
        """what `states` has returned since the last change, by language: views are frequent"""
        self._read()
        self.check_view = CheckView()
        self.threads: list[threading.Thread] = []
        """threads of checks and reports"""

    def states(self, language: str) -> dict[str, LessonState]:
        """Return what the seat has reached in each lesson that it has begun."""
        if language in self._states:
            return self._states[language]
        found = self._states[language] = {}
        for lesson in _lessons(language).values():
            if record := self._progress.lessons.get(lesson.name):
                given = tuple(
                    plain(lesson.hints[number - 1]) for number in record.hints if number <= len(lesson.hints)
                )
                more = len(lesson.hints) - len(given)
                found[lesson.name] = LessonState(bool(record.passed), record.tries, given, more)
        return found

    def hint(self, face: Face, request: AskHint) -> None:
        """Give the next hint of a lesson, and report that."""
        lesson = _lessons(face.state.choices.texts.code).get(request.lesson)
        if lesson is None:
            return
        with contextlib.suppress(
            BeatrixError
        ):  # the files are the teacher's concern; a check says it in `means`
            workspace = Workspace(self._folder)
            record = workspace.record(lesson.name)
            record.next_hint(lesson)
            workspace.save()
            self._progress, self._states = workspace.progress, {}
            session = None if face.own_link is None else face.own_link.session
            if session is not None:
                state, settings = record.state(), session.client.settings
                self._start(lambda: lesson_reports.report(lesson.name, state, settings))

    def check(self, face: Face, request: CheckProgram) -> None:
        """Run a program; if it can run with the simulation, judge what that does."""
        if self.check_view.checks:
            return  # it goes on, as its line says; a second press must not end it
        lesson = _lessons(face.state.choices.texts.code).get(request.lesson)
        session = None if face.own_link is None else face.own_link.session
        judged = face.driver is not None and "sim" in face.state.choices.sides
        if lesson is None or session is None or not judged:
            face.carry_out(RunBlocks(request.program))  # which says what is missing
            return
        self.check_view = CheckView(lesson.name, checks=True)
        client, robot = session.client, face.robot
        self._start(lambda: self._watch(face, lesson, request.program, client, robot))

    def _start(self, work: Callable[[], None]) -> None:
        self.threads = [thread for thread in self.threads if thread.is_alive()]
        self.threads.append(threads.start(work, "lesson"))

    # -- on a thread of its own -----------------------------------------------------------------------

    def _watch(self, face: Face, lesson: BlockLesson, program: str, client: Client, robot: str) -> None:
        """Observe one run, judge it, and keep the verdict."""
        view = CheckView(lesson.name)
        try:
            with OwnRun(client, robot, lesson.about.limit_s) as run:
                request = self._begun(face, program)
                while request is not None and not request.over.wait(LOOK_S):
                    if not run.look():
                        self._call(face.carry_out, EndBlocks())
            if request is not None and (request.ending is None or not run.in_time):
                verdict = run.verdict(lesson)
                view = _view(lesson, verdict)
                own_run.keep(lesson, verdict, program, self._folder, client.settings)
        except BeatrixError as error:
            view = msgspec.structs.replace(view, means=str(error))
        finally:
            self._call(self._show, face, view)

    def _begun(self, face: Face, program: str) -> BlockRun | None:
        """Let the loop begin the program; return None if it did not begin."""
        answer: queue.SimpleQueue[BlockRun | None] = queue.SimpleQueue()
        self._call(_begin, face, program, answer)
        try:
            return answer.get(timeout=BEGIN_S)
        except queue.Empty:
            return None

    # -- on the loop ----------------------------------------------------------------------------------

    def _show(self, face: Face, view: CheckView) -> None:
        self.check_view = view
        self._read()
        face.renew()

    def _read(self) -> None:
        with contextlib.suppress(BeatrixError):  # a check says that the file cannot be read
            self._progress, self._states = Workspace(self._folder).progress, {}


def _begin(face: Face, program: str, answer: queue.SimpleQueue[BlockRun | None]) -> None:
    moving = None if face.own_link is None else face.own_link.moving
    before = moving and moving.program
    face.carry_out(RunBlocks(program))
    found = moving and moving.program
    answer.put(found if isinstance(found, BlockRun) and found is not before else None)


def _view(lesson: BlockLesson, verdict: Verdict) -> CheckView:
    return CheckView(
        lesson.name,
        result=verdict.result.name.lower(),
        asked=verdict.asked,
        found=verdict.found,
        means=verdict.means,
        picture=verdict.picture,
    )


@cache
def _lessons(language: str) -> dict[str, BlockLesson]:
    return {lesson.name: lesson for lesson in block_lessons(language)}


@cache
def pages(language: str) -> msgspec.Raw:
    """Return all lessons in a language as JSON; encoded once, because views are frequent."""
    return msgspec.Raw(msgspec.json.encode(lesson_pages(language)))
