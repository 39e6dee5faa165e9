"""Whose turn it is, in large type: what the page for a projector shows."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_views import class_world, turns
from msgspec import structs

from gui.console.state import class_page
from gui.console.state.world import LinkPhase
from gui.console.texts import Texts

TEACHER = class_world()


def test_a_row_names_the_driver_the_time_left_and_the_next_seats() -> None:
    first, *others = TEACHER.robots
    assert first.status is not None
    waiting = ("ben", "cleo", "dora", "eva", "finn")
    robots = (replace(first, status=structs.replace(first.status, turn_s=43, waiting=waiting)), *others)
    shown = class_page.projector(replace(TEACHER, robots=robots, pupils={"ben": "Ben (3)"}), Texts("en"))
    moving = shown.rows[0]
    assert (moving.robot, moving.side, moving.driver) == ("bea1", "(simulation)", "ana")
    assert (moving.left, moving.state) == ("43 s left", "")
    assert moving.waiting == "Next: Ben (3), cleo, dora and\N{NO-BREAK SPACE}2\N{NO-BREAK SPACE}more"
    frozen = next(row for row in shown.rows if row.state == "frozen")
    assert frozen.driver == "dora"
    assert (shown.rows[-1].driver, shown.rows[-1].state) == ("", "silent"), "a silent robot names no driver"
    assert shown.empty == ""
    assert "beatrix stop" in shown.stop


def test_a_class_with_one_kind_of_robot_does_not_repeat_it() -> None:
    hardware = replace(TEACHER, robots=tuple(one for one in TEACHER.robots if one.side == "hw"))
    assert {row.side for row in class_page.projector(hardware, Texts("en")).rows} == {""}


@pytest.mark.parametrize(
    ("count", "columns", "lines"), [(1, 1, 1), (2, 1, 2), (3, 2, 2), (8, 2, 4), (9, 3, 3), (30, 5, 6)]
)
def test_columns_and_lines_follow_the_number_of_robots(count: int, columns: int, lines: int) -> None:
    shown = class_page.projector(turns(count), Texts("en"))
    assert (shown.columns, shown.lines) == (columns, lines)


def test_a_row_names_fewer_seats_if_their_names_are_long() -> None:
    queue = (
        class_page.projector(turns(4, long=True), Texts("en"))
        .rows[3]
        .waiting.replace("\N{NO-BREAK SPACE}", " ")
    )
    assert queue == "Next: Emil Maximiliane Schulze-Hohenstein (emil) and 2 more"


def test_the_projector_says_why_it_shows_no_robot() -> None:
    lost = replace(TEACHER, phase=LinkPhase.NO_ROUTER, robots=())
    assert "no router answers" in class_page.projector(lost, Texts("en")).empty.lower()
    assert class_page.projector(replace(TEACHER, robots=()), Texts("de")).empty
