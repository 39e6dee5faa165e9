"""The page of the class: rows, requests of the teacher, and STOP for all robots."""

from __future__ import annotations

import datetime as dt
import math
from dataclasses import replace
from typing import Any

import pytest
from golden import same
from gui_views import class_world, full_class, lesson
from gui_worlds import account, status, world
from present import present

from beatrix_zenoh.client.lesson_reports import Row
from beatrix_zenoh.contract._generated.messages import LeaseAction, Reason, SeatCount
from beatrix_zenoh.lessons.progress import Record
from gui.console.state import intents, lessons
from gui.console.state.actions import Govern, Outcome, SendStop, Watch
from gui.console.state.intents import Intent, LimitClass, Stop, TogglePage, WindowPage
from gui.console.state.lessons import LessonRowView, LessonsView, Progress
from gui.console.state.state import State
from gui.console.state.views import ClassView, Condition
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts

TEACHER = class_world()
PLACE = ("bea2", "hw")


def page(state: State, now: World = TEACHER) -> ClassView:
    return present(state.view(now).class_page)


def opened() -> State:
    """Return the state of a teacher's window that shows the class."""
    state = State()
    assert state.handle(TogglePage(), TEACHER) == [Watch(class_page=True)]
    return state


def test_only_the_teacher_has_the_page() -> None:
    state, student = State(), world()
    for intent in (TogglePage(), Govern(0, LeaseAction.FREEZE), LimitClass("20")):
        assert state.handle(intent, student) == []
    assert state.view(student).class_page is None
    assert state.view(student).choices.page is WindowPage.ROBOT


def test_a_row_shows_state_driver_queue_rate_and_age() -> None:
    rows = {row.place: row for row in page(opened()).rows}
    moving = rows["bea1", "sim"]
    queue = "ben, cleo"
    assert moving.cells == (
        "bea1",
        "Simulation",
        "► moving",
        "ana (taken)",
        "",
        queue,
        "50",
        "0.0 s",
        "limit 20 °/s",
    )
    assert rows[PLACE].cells[2:4] == ("■ frozen", "dora")
    assert rows["bea3", "sim"].condition is Condition.DISABLED
    assert rows["bea4", "sim"].condition is Condition.FAULT
    silent = rows["bea4", "hw"]
    assert silent.cells[6:8] == ("0", "3.2 s")
    same("state class.a row shows state driver queue rate and age", silent.details)


def test_the_page_shows_a_summary_and_the_speed_limit() -> None:
    view = page(opened())
    same("state class.the page shows a summary and the speed limit", view.summary)
    assert view.limit_now == "Speed limit: 20 °/s."


def test_a_seat_is_muted_on_all_robots_and_shown_as_muted() -> None:
    state = opened()
    shown = {view.text: view.mute.intent for view in page(state).seats}
    assert shown == {seat: Govern(0, LeaseAction.MUTE, seat=seat) for seat in ("ana", "ben", "cleo", "dora")}
    assert state.handle(shown["cleo"], TEACHER) == [Govern(1, LeaseAction.MUTE, (), 0.0, "cleo")]
    view = state.view(TEACHER)
    assert view.history[0].what == "mute cleo, all robots"
    muted = page(state, with_first(muted=("cleo", "zoe")))
    assert "Muted: cleo, zoe." in muted.summary
    buttons = {view.text: view.mute.intent for view in muted.seats}
    assert buttons["cleo (muted)"] == Govern(0, LeaseAction.UNMUTE, seat="cleo")
    assert buttons["zoe (muted)"] == Govern(0, LeaseAction.UNMUTE, seat="zoe"), "a seat that is not connected"
    assert state.handle(Govern(0, LeaseAction.MUTE, seat="ana"), world()) == [], "not the teacher's window"


def test_a_robot_that_was_away_when_a_seat_was_muted_is_named() -> None:
    """In a class only its own robots are named: a robot of a seat need not obey."""
    now = with_first(muted=("cleo",))
    for names, named in (((), {"bea2", "bea3", "bea4"}), (("bea1", "bea2"), {"bea2"})):
        rows = page(opened(), replace(now, account=account("teacher", robots=names))).rows
        assert {row.place[0] for row in rows if "not muted: cleo" in row.cells[-1]} - {"bea1"} == named


def test_a_pupil_is_shown_by_name_and_muted_by_seat() -> None:
    now = replace(TEACHER, account=account("teacher", names={"cleo": "Cléo Brun"}))
    (view,) = (view for view in page(opened(), now).seats if view.text == "Cléo Brun (cleo)")
    assert view.mute.intent == Govern(0, LeaseAction.MUTE, seat="cleo")
    muted = page(opened(), replace(with_first(muted=("cleo",)), account=now.account))
    assert [view.text for view in muted.seats] == ["ana", "ben", "Cléo Brun (cleo) (muted)", "dora"]


def with_first(**known: Any) -> World:
    """Return the world of the teacher in which the first robot has these fields in its status."""
    first, *others = TEACHER.robots
    return replace(TEACHER, robots=(replace(first, status=status("sim", **known)), *others))


def test_the_summary_counts_the_stops_of_each_seat() -> None:
    stops = (SeatCount(seat="cem", count=30), SeatCount(seat="", count=1))
    summary = page(opened(), with_first(stops=stops)).summary
    same("state class.the summary counts the stops of each seat 1", summary)


def test_different_speed_limits_are_shown_with_each_robot() -> None:
    mixed = page(opened(), with_first())
    same("state class.the summary counts the stops of each seat 2", mixed.limit_now)
    assert mixed.rows[2].cells[-1] == "limit 20 °/s"
    empty = page(opened(), replace(TEACHER, robots=()))
    assert (empty.limit_now, empty.rows) == ("No speed limit.", ())
    assert empty.empty.startswith("No robot is online.")


@pytest.mark.parametrize(
    ("day", "words"),
    [
        (dt.datetime(2027, 6, 1, tzinfo=dt.UTC), ""),
        (dt.datetime(2027, 6, 2, tzinfo=dt.UTC), "expire on 2027-07-31. Run"),
        (dt.datetime(2027, 8, 1, tzinfo=dt.UTC), "expired on 2027-07-31: no seat"),
    ],
)
def test_the_summary_announces_that_the_accounts_expire(day: dt.datetime, words: str) -> None:
    summary = page(opened(), replace(TEACHER, account=account("teacher"), wall_s=day.timestamp())).summary
    assert words in summary
    assert ("beatrix classroom init class.toml" in summary) == bool(words)


@pytest.mark.parametrize(
    ("intent", "action"),
    [
        (Govern(0, LeaseAction.FREEZE), Govern(1, LeaseAction.FREEZE)),
        (Govern(0, LeaseAction.UNFREEZE), Govern(1, LeaseAction.UNFREEZE)),
        (Govern(0, LeaseAction.TAKE, (PLACE,)), Govern(1, LeaseAction.TAKE, (PLACE,))),
        (LimitClass("20"), Govern(1, LeaseAction.LIMIT, (), math.radians(20))),
        (LimitClass(" 12,5 °/s "), Govern(1, LeaseAction.LIMIT, (), math.radians(12.5))),
        (LimitClass(""), Govern(1, LeaseAction.LIMIT, (), 0.0)),
    ],
)
def test_intents_of_the_teacher_become_requests(intent: Intent, action: Govern) -> None:
    assert opened().handle(intent, TEACHER) == [action]


@pytest.mark.parametrize("text", ["fast", "-5", "nan", "1e99", "20 30"])
def test_an_invalid_speed_limit_is_not_sent(text: str) -> None:
    state = opened()
    assert state.handle(LimitClass(text), TEACHER) == []
    view = page(state)
    assert f"'{text}' is not a speed" in view.result
    assert view.good is False


def test_the_outcome_is_shown_with_the_robots_that_failed() -> None:
    state = opened()
    state.handle(Govern(0, LeaseAction.FREEZE), TEACHER)
    assert page(state).good is None
    state.report(Outcome(1, "", accepted=True, done=True, robots=8))
    assert (page(state).result, page(state).good) == ("freeze, all robots: done by 8 robots", True)
    state.handle(LimitClass("20"), TEACHER)
    missed, why = ("bea3 (hw)", "bea4 (hw)"), "It did not answer."
    state.report(Outcome(2, "", False, True, Reason.TIMED_OUT, why, robots=8, failed=missed))
    same("state class.the outcome is shown with the robots that failed", page(state).result)
    assert page(state).good is False


def test_without_a_router_nothing_is_sent() -> None:
    state = opened()
    lost = replace(TEACHER, phase=LinkPhase.NO_ROUTER, robots=())
    assert state.handle(Govern(0, LeaseAction.FREEZE), lost) == []
    assert "no router answers" in page(state, lost).result


def test_both_stops_on_the_page_of_the_class_are_for_all_robots() -> None:
    state = opened()
    view = state.view(TEACHER)
    assert (view.stop.text, view.emergency.text) == ("STOP ALL", "EMERGENCY STOP ALL")
    assert state.handle(Stop(), TEACHER) == [SendStop(1, everywhere=True)]
    assert state.handle(view.emergency.intent, TEACHER) == [SendStop(2, everywhere=True, emergency=True)]
    state.report(Outcome(2, "", accepted=True, done=True, robots=8))
    same("state class.an emergency stop on the page of the class goes to all robots", page(state).result)
    assert state.handle(TogglePage(), TEACHER)[0] == Watch()
    assert state.handle(Stop(), TEACHER) == [SendStop(3)]
    assert state.handle(intents.Repeat(1), TEACHER) == [SendStop(4, everywhere=True)]


# -- lessons -----------------------------------------------------------------------------------------

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
        ([lesson("ana", "01-hello"), lesson("ana", "02-steps", passed=True)], ("01-hello", "○ trying (2)")),
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
