"""Check one program of one lesson, and say what came of it: as text, and as JSON."""

from __future__ import annotations

import contextlib
import runpy
import shutil
import textwrap
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lesson_files import Lesson
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.phrases import (
    Checked,
    NotMeasurable,
    Phrase,
    Unmet,
    busy,
    error_data,
    phrase,
    said,
)
from beatrix_zenoh.lessons.picture import svg
from beatrix_zenoh.lessons.program import Program
from beatrix_zenoh.lessons.progress import Record
from beatrix_zenoh.lessons.stage import Stages, open_stage
from beatrix_zenoh.output import say

BUSY_CORES = 0.5
"""A program that uses a larger part of a core keeps the computer busy itself."""
LOADING = threading.Lock()
"""runpy may run in one thread at a time only; a page server checks for many pupils."""


class Result(Enum):
    """What came of a check; the values are its exit codes."""

    PASSED = 0
    NOT_YET = 1
    NOT_MEASURABLE = 4


@dataclass(frozen=True)
class Verdict:
    """The result of a check, and what to say about it."""

    result: Result
    figure: str = ""
    """the first figure that is not met"""
    asked: str = ""
    found: str = ""
    means: str = ""
    """what that means; or why nothing was measured"""
    hint: int = 0
    """number of the hint that helps; 0: none"""
    values: dict[str, object] = field(default_factory=dict)
    """the values behind the sentences"""
    picture: str = ""
    """what was asked and done, as SVG; empty: there is none"""


def check(
    lesson: Lesson,
    program: Program,
    *,
    keep: Path | None = None,
    tell: Callable[[str], None] = lambda _: None,
    stages: Stages = open_stage,
) -> Verdict:
    """Check a program.

    Args:
        lesson: the lesson, in the pupil's language.
        program: the pupil's program.
        keep: record the robots of an observed run to this file, which is overwritten.
        tell: is called with sentences about a check that takes long, in the language of the lesson.
        stages: runs the stages of the check.
    """
    attempt = Attempt(
        program,
        limit_s=lesson.about.limit_s,
        keep=keep,
        tell=lambda text: tell(str(said(text, lesson.language))),
        stages=stages,
    )

    def run() -> None:
        with attempt:
            program.compile()
            check_of(lesson)(attempt)

    found = judged(lesson, attempt, run)
    if found.result is Result.PASSED and program.changed():
        return not_measurable(lesson, phrase("changed", file=program.path.name))
    return found


def judged(lesson: Lesson, checked: Checked, run: Callable[[], None]) -> Verdict:
    """Return the verdict of a check that `run` makes."""
    try:
        run()
    except Unmet as unmet:
        if checked.doubt:
            return not_measurable(lesson, busy(checked.doubt).why, checked.cores)
        picture = svg(checked.panels, lesson.language) if checked.panels else ""
        return replace(verdict(lesson, unmet), picture=picture)
    except NotMeasurable as why:
        return not_measurable(lesson, why.why, checked.cores)
    except BeatrixError as error:
        return not_measurable(lesson, phrase("stuck", error=error_data(error).unnamed))
    return Verdict(Result.PASSED)


def check_of(lesson: Lesson) -> Callable[[Checked], None]:
    """Return the function `check` of a lesson's check.py."""
    with LOADING:
        check: Callable[[Checked], None] = runpy.run_path(str(lesson.folder / "check.py"))["check"]
    return check


def not_measurable(lesson: Lesson, why: Phrase, cores: float = 0.0) -> Verdict:
    """Return the verdict of a check that has judged nothing; the program has used this part of a core."""
    if cores > BUSY_CORES:
        why = phrase("own_share", why=why, cores=cores)
    return Verdict(Result.NOT_MEASURABLE, means=str(said(why, lesson.language)))


def count(record: Record, verdict: Verdict, entry: str) -> None:
    """Add a verdict to the record of a lesson, with the program's `entry`; a computer that was too busy is no try."""
    if verdict.result is Result.NOT_MEASURABLE:
        return
    record.tries += 1
    known = verdict.figure in (*record.seen, record.figure)  # records of earlier versions have `figure` only
    record.stuck = record.stuck + 1 if known else 1
    record.figure = verdict.figure
    if not known:
        record.seen.append(verdict.figure)
    if verdict.result is Result.PASSED:
        record.stuck, record.seen = 0, []
        record.passed = [one for one in record.passed if one != entry] + [entry]


def _shown(value: object) -> object:
    """Return a value for sentences; `lesson start` has copied a file of the lesson, so that its name is enough."""
    if isinstance(value, Path):
        return value.name
    return value.tolist() if hasattr(value, "tolist") else value


def verdict(lesson: Lesson, unmet: Unmet) -> Verdict:
    """Return what to say about a figure that is not met."""
    figure = lesson.figure(unmet.figure)
    values = {name: said(_shown(value), lesson.language) for name, value in unmet.values.items()}
    asked, found, means = (text.format(**values) for text in (figure.asked, figure.found, figure.means))
    return Verdict(Result.NOT_YET, unmet.figure, asked, found, means, figure.hint, values)


FURTHER = "Next: the last part of the page; how we did it: `beatrix lesson solution {number}`."
LABELS = {
    "en": (
        "Passed: {title}.",
        "Not yet: {title} (try {tries}).",
        "asked",
        "found",
        "Hint",
        FURTHER,
        "Picture",
    ),
    "de": (
        "Bestanden: {title}.",
        "Noch nicht: {title} (Versuch {tries}).",
        "verlangt",
        "gefunden",
        "Hinweis",
        "Weiter: der letzte Teil der Seite; so haben wir es gelöst: `beatrix lesson solution {number}`.",
        "Bild",
    ),
}
WIDTH = 100
"""Longest line of a hint or an explanation (characters)."""


def filled(text: str, indent: str = "") -> str:
    """Return a text in lines that fit into the terminal, each after `indent`."""
    width = min(WIDTH, shutil.get_terminal_size().columns)
    return textwrap.fill(
        " ".join(text.split()), width, initial_indent=indent, subsequent_indent=indent, break_long_words=False
    )


def keep_picture(verdict: Verdict, file: Path) -> Path | None:
    """Write the picture of a verdict; return the file, or None if there is no picture: then no older one is left."""
    with contextlib.suppress(OSError):  # the verdict is more important
        file.unlink(missing_ok=True)
        if verdict.picture:
            file.write_text(verdict.picture, encoding="utf-8")
            return file
    return None


def document(found: Lesson, verdict: Verdict, record: Record, picture: Path | None) -> dict[str, object]:
    """Return a verdict as JSON."""
    plain = int | float | str | None
    return {
        "result": verdict.result is Result.PASSED,
        "lesson": found.name,
        "outcome": verdict.result.name.lower(),
        "figure": verdict.figure,
        "asked": verdict.asked,
        "found": verdict.found,
        "message": verdict.means,
        "hint": verdict.hint,
        "values": {name: one if isinstance(one, plain) else str(one) for name, one in verdict.values.items()},
        "tries": record.tries,
        "picture": "" if picture is None else str(picture),
    }


def show(found: Lesson, verdict: Verdict, record: Record, picture: Path | None) -> None:
    """Print a verdict for the pupil."""
    passed, not_yet, asked, wrong, hint, further, seen = LABELS[found.language]
    if verdict.result is Result.PASSED:
        say(passed.format(title=found.title))
        say(further.format(number=found.number))
        return
    if verdict.result is Result.NOT_MEASURABLE:
        say(filled(verdict.means))
        return
    say(not_yet.format(title=found.title, tries=record.tries))
    width = max(len(asked), len(wrong))
    say(f"  {asked:<{width}}  {verdict.asked}")
    say(f"  {wrong:<{width}}  {verdict.found}")
    say(filled(verdict.means, "  "))
    if verdict.hint:
        say(f"  {hint}: beatrix lesson hint {found.number}")
    if picture is not None:
        say(f"  {seen}: {picture}")
