"""Every solution passes its check, no start does, and the texts of every lesson are complete."""

from __future__ import annotations

import re

import pytest
from lesson_checks import checked, of_lesson

from beatrix_zenoh.lessons.checking import OWN_SHARE, Result, Verdict, not_measurable, verdict
from beatrix_zenoh.lessons.lesson import LIBRARY, Lesson, lessons
from beatrix_zenoh.lessons.stage import Stage
from beatrix_zenoh.lessons.unmet import Unmet, busy

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
        (Unmet("function", function="double", names="none"), "Funktionen der Datei: keine"),
        (Unmet("function", function="double", names="twice"), "Funktionen der Datei: twice"),
        (
            Unmet("ends", what="Your function", name=" double", limit=2.0),
            "Deine Funktion double war nach 2 s noch nicht fertig",
        ),
        (
            Unmet(
                "uncaught",
                error="Refused: The head would lean 40.0°; at most 35.0° is allowed. Try a speed of 9.5°/s.",
                where=" (cell 2, line 4)",
            ),
            (
                "Refused: Der Kopf stünde 40,0° schräg; höchstens 35,0° sind erlaubt. "
                "Versuche es mit der Geschwindigkeit 9,5°/s. (Zelle 2, Zeile 4)"
            ),
        ),
        (Unmet("keyboard", where=" (line 12)"), "es wartet auf input() (Zeile 12)"),
    ],
)
def test_a_check_in_german_inserts_no_english(unmet: Unmet, found: str) -> None:
    assert verdict(Lesson(LIBRARY / "01-hello", "de"), unmet).found == found


def test_phrases_of_checks_are_translated() -> None:
    german = Lesson(LIBRARY / "01-hello", "de")
    code = "".join((LIBRARY.parent / name).read_text(encoding="utf-8") for name in ("attempt.py", "bench.py"))
    phrases = re.findall(r'(?:what|wanted)="([^"]+)"', code)
    phrases += re.findall(r'wanted = "([^"]+)" if .* else "([^"]+)"', code)[0]
    assert len(phrases) > 5
    assert [phrase for phrase in phrases if german.phrase(phrase) == phrase] == []


def test_a_computer_that_is_too_busy_says_so_in_german() -> None:
    german = Lesson(LIBRARY / "01-hello", "de")
    for why in (
        "For 2126 ms there was no position; 100 ms are allowed.",
        "The simulation ran at 0.52 times the speed of reality.",
        "The simulation was not ready within 60 s.",
        "The bench did not answer.",
    ):
        text = f"{busy(why)} (It did not end within 40 s: is there a `while True`?)" + OWN_SHARE.format(
            cores=1.0
        )
        shown = not_measurable(german, text).means
        assert not re.search(r"\b(the|not|was|is|of|times)\b", shown), shown


def test_a_file_of_a_lesson_is_named_as_the_pupil_has_it() -> None:
    lesson = Lesson(LIBRARY / "09-follow-the-face")
    file = lesson.folder / "files/07.jpg"
    assert file.is_file(), "`lesson start` copies it"
    said = verdict(lesson, Unmet("missed", file=file, bearing=14.4))
    assert said.asked == "14.4 deg for 07.jpg"
    assert str(LIBRARY) not in str(said.values)


def test_an_unmet_figure_names_its_values() -> None:
    assert str(Unmet("nods", count=2)) == "nods"
    assert (LIBRARY / "figures.toml").is_file()
