"""Every wrong program of a lesson fails with its figure. A file of its own, to run beside the solutions."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest
from lesson_checks import Wrong, checked, of_lesson, wrong_programs

from beatrix_zenoh.lesson_files import LIBRARY, Lesson, lessons
from beatrix_zenoh.lessons.stage import Stage

pytestmark = pytest.mark.timeout(400)  # a check may take two minutes, and is tried twice

NAMES = [lesson.name for lesson in lessons()]
PROGRAMS = [
    of_lesson((lesson, wrong), lesson, f"{lesson}/{name}")
    for lesson in NAMES
    for name, wrong in wrong_programs(lesson).items()
]
ENDLESS_S = 5.0
"""Limit (s) of programs that never end: their lessons allow more."""


def solution(lesson: Lesson) -> str:
    return (lesson.folder / "solution.py").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_wrong_programs_differ_from_their_solution(name: str) -> None:
    right = solution(Lesson(LIBRARY / name))
    programs = [wrong.program(right) for wrong in wrong_programs(name).values()]
    assert 2 <= len({*programs} - {right}) == len(programs) <= 5
    for text in programs:
        compile(text, name, "exec")


@pytest.mark.parametrize("case", PROGRAMS)
def test_a_wrong_program_fails_with_its_figure(case: tuple[str, Wrong], stage: Stage, tmp_path: Path) -> None:
    lesson, wrong = Lesson(LIBRARY / case[0]), case[1]
    path = tmp_path / "start.py"
    path.write_text(wrong.program(solution(lesson)), encoding="utf-8")
    if wrong.expects == "ends":
        lesson.about = msgspec.structs.replace(lesson.about, limit_s=ENDLESS_S)
    verdict = checked(lesson, path, stage)
    assert verdict.figure == wrong.expects, verdict
    assert verdict.means
