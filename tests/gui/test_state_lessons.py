"""The lessons of the class, as the page of the class shows them: rows, marks, and why there are none."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_views import class_world, full_class, lesson

from beatrix_zenoh.client.lesson_reports import Row
from beatrix_zenoh.lessons.progress import Record
from gui.console.state import lessons
from gui.console.state.lessons import LessonRowView, LessonsView, Progress
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts

NOT_MEASURED = Row("ana", "01-hello", Record().state(measured=False))
STUCK = lesson("ana", "03-arms", stuck=5, tries=9)


def shown(*reports: Row, now: World | None = None, language: str = "en") -> LessonsView:
    world = replace(now or class_world(), reports=tuple(sorted(reports)))
    return lessons.view(world, Texts(language))


def row(*reports: Row) -> LessonRowView:
    return next(row for row in shown(*reports).rows if row.seat == "ana")


def test_a_row_shows_the_lesson_its_progress_and_the_number_of_passed_lessons() -> None:
    made = row(lesson("ana", "01-hello", passed=True), lesson("ana", "02-steps", passed=True), STUCK)
    assert made.cells == (
        "ana",
        "03-arms",
        "▲ stuck for 5 checks; asked: a program that ends without an error",
        "2",
    )
    assert made.progress is Progress.STUCK
    assert made.marks == (Progress.PASSED, Progress.PASSED, Progress.STUCK)
    assert made.details.splitlines() == [
        "01-hello: ✓ passed (2)",
        "02-steps: ✓ passed (2)",
        "03-arms: ▲ stuck for 5 checks; asked: a program that ends without an error",
    ]


@pytest.mark.parametrize(
    ("reports", "cell"),
    [
        ([lesson("ana", "01-hello", passed=True)], ("01-hello", "✓ passed (2)")),
        ([NOT_MEASURED], ("01-hello", "? computer too busy to measure (0)")),
        ([lesson("ana", "01-hello", stuck=4, tries=4)], ("01-hello", "○ trying (4)")),
        ([lesson("ana", "01-hello", passed=True, tries=1000)], ("01-hello", "✓ passed (1000)")),
        ([lesson("ana", "01-hello", passed=True, tries=65535)], ("01-hello", "✗ impossible (65535)")),
        ([lesson("ana", "01-hello", passed=True, tries=0)], ("01-hello", "✗ impossible (0)")),
        ([lesson("ana", "01-hello", stuck=6, tries=5)], ("01-hello", "✗ impossible (5)")),
        (
            [lesson("ana", "01-hello"), lesson("ana", "02-steps", passed=True)],
            ("01-hello", "○ trying (2)"),
        ),
        ([lesson("ana", "01-hello"), lesson("ana", "02-steps", tries=1)], ("02-steps", "○ trying (1)")),
        (
            [STUCK, lesson("ana", "04-look-there")],
            ("03-arms", "▲ stuck for 5 checks; asked: a program that ends without an error"),
        ),
    ],
)
def test_the_lesson_of_a_seat_is_the_one_that_needs_help(reports: list[Row], cell: tuple[str, str]) -> None:
    assert row(*reports).cells[1:3] == cell


def test_stuck_seats_come_first_and_are_counted_in_the_title() -> None:
    view = shown(lesson("zoe", "01-hello", stuck=6), lesson("ben", "02-steps", passed=True))
    assert [row.seat for row in view.rows] == ["zoe", "ana", "ben", "cleo", "dora"]
    assert view.title == "Lessons: 1 stuck"
    assert view.columns == ("01", "02")
    connected = view.rows[1]
    assert connected.cells == ("ana", "", "no check yet", "")
    assert connected.marks == (Progress.NONE, Progress.NONE)
    assert shown(lesson("ben", "01-hello")).title == "Lessons"


@pytest.mark.parametrize("language", ["en", "de"])
def test_an_empty_page_says_why(language: str) -> None:
    texts, now = Texts(language), class_world()
    reading = lessons.view(now, texts).empty
    failed = lessons.view(replace(now, reports_failed=True), texts).empty
    none = lessons.view(replace(now, reports=()), texts).empty
    lost = lessons.view(replace(now, phase=LinkPhase.NO_ROUTER), texts).empty
    assert len({reading, failed, none, lost, ""}) == 5
    assert "beatrix join" in none


def test_old_reports_stay_and_are_marked_as_old() -> None:
    now = full_class()
    assert lessons.view(now, Texts("en")).notice == ""
    for late in (replace(now, reports_failed=True), replace(now, phase=LinkPhase.NO_ROUTER)):
        view = lessons.view(late, Texts("en"))
        assert len(view.rows) == 30
        assert view.notice.startswith("These reports may be old")
