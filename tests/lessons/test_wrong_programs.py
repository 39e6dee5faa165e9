"""Every wrong program of a lesson fails with the figure in its first line. A file of its own, to run beside the solutions."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest
from lesson_checks import checked, of_lesson

from beatrix_zenoh.lessons.lesson import LIBRARY, Lesson
from beatrix_zenoh.lessons.stage import Stage

EXPECTS = re.compile(r"^# expects: (\S+)")
pytestmark = pytest.mark.timeout(400)  # a check may take two minutes, and is tried twice

PROGRAMS = [
    of_lesson(path, path.parent.parent.name, f"{path.parent.parent.name}/{path.stem}")
    for path in sorted(LIBRARY.glob("*/wrong/*.py"))
]
ENDLESS_S = 5.0
"""Limit (s) of programs that never end: their lessons allow more."""


@pytest.mark.parametrize("path", PROGRAMS)
def test_a_wrong_program_fails_with_its_figure(path: Path, stage: Stage) -> None:
    lesson = Lesson(path.parent.parent)
    expected = EXPECTS.match(path.read_text(encoding="utf-8"))
    assert expected, "the first line is `# expects: FIGURE`"
    if expected[1] == "ends":
        lesson.about = msgspec.structs.replace(lesson.about, limit_s=ENDLESS_S)
    verdict = checked(lesson, path, stage)
    assert verdict.figure == expected[1], verdict
    assert verdict.means
