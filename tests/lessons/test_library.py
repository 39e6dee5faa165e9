"""Every solution passes its check; every start and every wrong program fails with the figure it is meant for."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from beatrix_zenoh.lessons import program
from beatrix_zenoh.lessons.checking import Result, Verdict, check
from beatrix_zenoh.lessons.lesson import LIBRARY, Lesson, lessons
from beatrix_zenoh.lessons.stage import Stage
from beatrix_zenoh.lessons.unmet import Unmet

LESSONS = lessons()
EXPECTS = re.compile(r"^# expects: (\S+)")
FIGURE = re.compile(r'(?:require\(|Unmet\()\s*"([\w-]+)"')
WRONG = [path for lesson in LESSONS for path in sorted((lesson.folder / "wrong").glob("*.py"))]
BUSY_TRIES = 3
ENDLESS_S = 10.0
"""Limit (s) of programs that never end: their lessons allow more."""


@pytest.fixture(scope="session")
def stage() -> Iterator[Stage]:
    """One simulation for all observed checks, because its start takes as long as most programs."""
    with Stage() as stage:
        yield stage


def checked(lesson: Lesson, path: Path, stage: Stage) -> Verdict:
    """Check a program; a busy computer is no verdict, so try again."""
    why = ""
    for _ in range(BUSY_TRIES):
        verdict = check(lesson, program.read(path), stage=stage)
        if verdict.result is not Result.NOT_MEASURABLE:
            return verdict
        why = verdict.means
    pytest.skip(why)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_the_solution_passes(lesson: Lesson, stage: Stage) -> None:
    verdict = checked(lesson, lesson.folder / "solution.py", stage)
    assert verdict == Verdict(Result.PASSED)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_the_start_does_not_pass(lesson: Lesson, stage: Stage) -> None:
    verdict = checked(lesson, lesson.folder / "start.py", stage)
    assert verdict.result is Result.NOT_YET
    assert verdict.hint, f"{verdict.figure} of the start has no hint"


@pytest.mark.parametrize("path", WRONG, ids=lambda path: f"{path.parent.parent.name}/{path.stem}")
def test_a_wrong_program_fails_with_its_figure(path: Path, stage: Stage) -> None:
    lesson = Lesson(path.parent.parent)
    expected = EXPECTS.match(path.read_text(encoding="utf-8"))
    assert expected, "the first line is `# expects: FIGURE`"
    if expected[1] == "ends":
        lesson.about = msgspec.structs.replace(lesson.about, limit_s=ENDLESS_S)
    verdict = checked(lesson, path, stage)
    assert verdict.figure == expected[1], verdict
    assert verdict.means


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
@pytest.mark.parametrize("language", ["en", "de"])
def test_texts_are_complete(lesson: Lesson, language: str) -> None:
    lesson = Lesson(lesson.folder, language)
    assert len(lesson.hints) == 3
    assert all(60 <= len(hint.split()) <= 180 for hint in lesson.hints)
    for name in FIGURE.findall((lesson.folder / "check.py").read_text(encoding="utf-8")):
        assert lesson.figure(name).hint in range(4)
    for file in ("lesson.md", "teacher.md", "start.py", "solution.py", "lesson.toml"):
        assert (lesson.folder / file).is_file()
    assert 2 <= len(list((lesson.folder / "wrong").glob("*.py"))) <= 4


def test_an_unmet_figure_names_its_values() -> None:
    assert str(Unmet("nods", count=2)) == "nods"
    assert (LIBRARY / "figures.toml").is_file()
