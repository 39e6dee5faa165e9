"""Every solution passes its check, no start does, and the texts of every lesson are complete."""

from __future__ import annotations

import re
from string import Formatter

import pytest
from lesson_checks import checked, of_lesson

from beatrix_zenoh.lesson_files import LIBRARY, Lesson, lessons
from beatrix_zenoh.lessons.checking import Result, Verdict, verdict
from beatrix_zenoh.lessons.phrases import Unmet, phrase, phrases
from beatrix_zenoh.lessons.stage import Stage

LESSONS = lessons()
CHECKED = [of_lesson(lesson, lesson.name, lesson.name) for lesson in LESSONS]

pytestmark = pytest.mark.timeout(400)  # a check may take two minutes, and is tried twice
FIGURE = re.compile(r'(?:require\(|Unmet\()\s*"([\w-]+)"')


@pytest.mark.parametrize("lesson", CHECKED)
def test_the_solution_passes(lesson: Lesson, stage: Stage) -> None:
    verdict = checked(lesson, lesson.folder / "solution.py", stage)
    assert verdict == Verdict(Result.PASSED)


@pytest.mark.parametrize("lesson", CHECKED)
def test_the_start_does_not_pass(lesson: Lesson, stage: Stage) -> None:
    verdict = checked(lesson, lesson.folder / "start.py", stage)
    assert verdict.result is Result.NOT_YET
    assert verdict.hint, f"{verdict.figure} of the start has no hint"


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


@pytest.mark.parametrize(
    ("unmet", "found"),
    [
        (Unmet("function", function="double", names=phrase("none")), "Funktionen der Datei: keine"),
        (Unmet("function", function="double", names="twice"), "Funktionen der Datei: twice"),
        (
            Unmet("ends", what=phrase("function", name="double"), limit=2.0),
            "Deine Funktion double war nach 2 s noch nicht fertig",
        ),
        (
            Unmet("keyboard", where=phrase("where", place=phrase("line", line=12))),
            "es wartet auf input() (Zeile 12)",
        ),
    ],
)
def test_a_check_in_german_inserts_no_english(unmet: Unmet, found: str) -> None:
    assert verdict(Lesson(LIBRARY / "01-hello", "de"), unmet).found == found


def test_every_phrase_is_used_and_has_the_same_values_in_both_languages() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in LIBRARY.parent.glob("*.py"))
    used = re.findall(r'(?:phrase|Still)\((?:self\._)?(?:tell, )?"(\w+)"', code)
    assert {*used} == {*phrases()}
    for texts in phrases().values():
        english, german = (
            {field for _, field, _, _ in Formatter().parse(texts[one])} for one in ("en", "de")
        )
        assert english == german, texts
