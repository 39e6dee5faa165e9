"""The lessons in the strip below the header: their page, check, verdict and hints."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Final, Literal

from beatrix_zenoh.files import from_here
from beatrix_zenoh.lesson_files import Lesson, lessons
from gui.console.state.actions import Action, OpenProgram, RunLesson
from gui.console.state.intents import Intent
from gui.console.state.memory import Memory
from gui.console.state.views import ButtonView, StripView, button
from gui.console.state.world import CheckReport, World
from gui.console.texts import Texts

Sheet = Literal["", "page", "hint", "picture"]
MARKS: Final = {True: "●", False: "○"}
"""Dots of the progress: done, and not yet."""


class OpenLesson(Intent, frozen=True):
    """Show a lesson with its page; it is started if it was not yet."""

    number: int


class ShowSheet(Intent, frozen=True):
    """Show the page of the lesson, its next hint, or the picture of its last check."""

    sheet: Sheet
    """empty: hide it"""


@cache
def known(language: str) -> tuple[Lesson, ...]:
    """Return all lessons in Python; their files are read once."""
    return tuple(lessons(language))


class LessonStrip:
    """Which lesson is shown; used like `Memory`, in one thread."""

    def __init__(self) -> None:
        """Begin with the first lesson that has not passed."""
        self._number = 0
        self._sheet: Sheet = ""
        self._seen = CheckReport()

    def handle(self, memory: Memory, world: World, intent: OpenLesson | ShowSheet) -> list[Action]:
        """Show a lesson, its page or a picture."""
        if isinstance(intent, ShowSheet):
            self._sheet = intent.sheet
            return [RunLesson("hint", self._shown(memory, world).number)] if intent.sheet == "hint" else []
        changes, self._number, self._sheet = intent.number != self._number, intent.number, "page"
        lesson, code = self._shown(memory, world), memory.choices.texts.code
        ends = [RunLesson("end")] if changes and world.lesson.watched else []
        begun = lesson.name in world.lesson.programs
        return [*ends, *([] if begun else [RunLesson("start", lesson.number, code)])]

    def passes(self, world: World) -> bool:
        """Return whether a check has passed since the last call; its lesson stays until another one is chosen."""
        new, self._seen = world.lesson.report is not self._seen, world.lesson.report
        passed = new and self._seen.outcome == "passed"
        if passed:
            named = (one.number for one in known("en") if one.name == self._seen.lesson)
            self._number = next(named, self._number)
        return passed

    def menu(self, memory: Memory, world: World) -> tuple[ButtonView, ...]:
        """Return an entry for each lesson."""
        return tuple(
            ButtonView(
                f"{MARKS[one.name in world.lesson.passed]} {one.number}  {one.title}",
                one.goal,
                OpenLesson(one.number),
            )
            for one in known(memory.choices.texts.code)
        )

    def sheet(self, memory: Memory, world: World) -> tuple[str, str]:
        """Return the text (Markdown) and the picture (file) of the sheet; both empty: there is none."""
        if self._sheet == "page":
            here = memory.choices.texts("strip.here")
            title, _, text = self._shown(memory, world).page.read_text(encoding="utf-8").partition("\n")
            return f"{title}\n\n{here}\n{text}", ""
        hint = world.lesson.hint if self._sheet == "hint" else ""
        return hint, world.lesson.report.picture if self._sheet == "picture" else ""

    def view(self, memory: Memory, world: World, close: ButtonView) -> StripView:
        """Return the present lesson with its buttons."""
        texts, run, lesson = memory.choices.texts, world.lesson, self._shown(memory, world)
        all_known = known(texts.code)
        own = run.report.lesson in ("", lesson.name)
        report = run.report if own else CheckReport()
        passed, begun = lesson.name in run.passed, lesson.name in run.programs
        program = Path(run.programs[lesson.name]) if begun else None
        head = texts("strip.lesson", number=float(lesson.number), title=lesson.title)
        text, watches = _said(report, texts) or lesson.goal, run.watched == lesson.number
        if program is not None and not report.outcome and not run.note:
            text = f"{text} {texts('strip.program', file=str(from_here(program)))}"
        after = next((one.number for one in all_known if one.number > lesson.number), 1)
        check = RunLesson("end" if watches else "watch", lesson.number)
        read = button(texts, "strip.read", OpenLesson(lesson.number))
        buttons = (
            button(texts, "strip.picture", ShowSheet("picture")) if report.picture else None,
            read if self._sheet != "page" else button(texts, "strip.hide", ShowSheet("")),
            button(texts, "strip.code", OpenProgram(program)) if begun else None,
            button(texts, "strip.end" if watches else "strip.check", check) if begun else None,
            button(texts, "strip.hint", ShowSheet("hint")) if begun else None,
            button(texts, "strip.next", OpenLesson(after)),
            close,
        )
        return StripView(
            text="\n".join(filter(None, (f"{head} {text}", run.note))),
            progress="".join(MARKS[one.name in run.passed] for one in all_known),
            count=texts("strip.count", done=float(len(run.passed)), count=float(len(all_known))),
            good=_good(report, passed=passed),
            buttons=tuple(one for one in buttons if one is not None),
        )

    def _shown(self, memory: Memory, world: World) -> Lesson:
        all_known = known(memory.choices.texts.code)
        open_ones = (one for one in all_known if one.name not in world.lesson.passed)
        chosen = next((one for one in all_known if one.number == self._number), None)
        return chosen or next(open_ones, all_known[0])


def _good(report: CheckReport, *, passed: bool) -> bool | None:
    """Return whether a lesson has passed; None: not checked yet."""
    if report.outcome == "not_yet":
        return False
    return True if report.outcome == "passed" or (passed and not report.outcome) else None


def _said(report: CheckReport, texts: Texts) -> str:
    """Return what a check says; empty: nothing."""
    if report.outcome == "not_yet":
        return texts("strip.not_yet", asked=report.asked, found=report.found, means=report.message)
    if report.outcome in ("checks", "passed"):
        return texts(f"strip.{report.outcome}")
    return report.message
