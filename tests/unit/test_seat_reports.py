"""What the router of a class makes of a seat's reports about one lesson, which may come from several folders."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.bus.reports import SeatReport
from beatrix_zenoh.contract._generated.messages import LessonState


def state(tries: int, *, hints: int = 0, stuck: int = 0, passed: bool = False) -> LessonState:
    figure = "nods" if stuck else ""
    return LessonState(version=1, tries=tries, hints=hints, figure=figure, stuck=stuck, passed=passed)


def reported(*states: LessonState) -> SeatReport:
    made = SeatReport(states[0])
    for one in states[1:]:
        made.add(one)
    return made


@pytest.mark.parametrize(
    ("tries", "total"),
    [
        ([1, 2, 2, 3], 3),
        ([7, 1, 2], 9),
        ([5, 1, 6, 2], 8),
        ([3, 0, 1], 4),
        ([4, 9], 9),
        ([65535, 9], 65535),
    ],
)
def test_the_tries_of_all_folders_of_a_seat_are_added(tries: list[int], total: int) -> None:
    assert reported(*map(state, tries)).state.tries == total


def test_the_newest_report_says_where_a_seat_is_stuck() -> None:
    kept = reported(state(7, hints=2, stuck=6), state(1, stuck=1)).state
    assert (kept.tries, kept.hints, kept.stuck) == (8, 2, 1)


def test_a_lesson_that_was_passed_in_another_folder_stays_passed() -> None:
    assert reported(state(2, passed=True), state(1)).state.passed


@given(st.lists(st.integers(0, 65535), min_size=2, max_size=40))
def test_tries_never_fall(tries: list[int]) -> None:
    made = SeatReport(state(tries[0]))
    for one in tries[1:]:
        before = made.state.tries
        made.add(state(one))
        assert made.state.tries >= before
