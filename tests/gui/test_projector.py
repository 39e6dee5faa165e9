"""Whose turn it is, in large type: what the projector shows, and how the window draws it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gui_views import class_world, turns
from msgspec import structs
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from recording_link import RecordingLink

from gui.console.state import projector
from gui.console.state.intents import Choose
from gui.console.state.world import LinkPhase
from gui.console.texts import LANGUAGES, Texts
from gui.window.widgets.projector import ProjectorScreen, RobotCard, cut_in_middle
from gui.window.window import Window

TEACHER = class_world()
SIZES = [(1366, 768), (1920, 1080), (1024, 600)]


# -- what is shown ----------------------------------------------------------------------------------


def test_a_row_names_the_driver_the_time_left_and_the_next_seats() -> None:
    first, *others = TEACHER.robots
    assert first.status is not None
    waiting = ("ben", "cleo", "dora", "eva", "finn")
    robots = (replace(first, status=structs.replace(first.status, turn_s=43, waiting=waiting)), *others)
    shown = projector.view(replace(TEACHER, robots=robots, pupils={"ben": "Ben (3)"}), Texts("en"))
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
    assert {row.side for row in projector.view(hardware, Texts("en")).rows} == {""}


@pytest.mark.parametrize(
    ("count", "columns", "lines"), [(1, 1, 1), (2, 1, 2), (3, 2, 2), (8, 2, 4), (9, 3, 3), (30, 5, 6)]
)
def test_columns_and_lines_follow_the_number_of_robots(count: int, columns: int, lines: int) -> None:
    shown = projector.view(turns(count), Texts("en"))
    assert (shown.columns, shown.lines) == (columns, lines)


def test_a_row_names_fewer_seats_if_their_names_are_long() -> None:
    queue = (
        projector.view(turns(4, long=True), Texts("en")).rows[3].waiting.replace("\N{NO-BREAK SPACE}", " ")
    )
    assert queue == "Next: Emil Maximiliane Schulze-Hohenstein (emil) and 2 more"


def test_the_projector_says_why_it_shows_no_robot() -> None:
    lost = replace(TEACHER, phase=LinkPhase.NO_ROUTER, robots=())
    assert "no router answers" in projector.view(lost, Texts("en")).empty.lower()
    assert projector.view(replace(TEACHER, robots=()), Texts("de")).empty


# -- the window -------------------------------------------------------------------------------------


def shown(window: Window, link: RecordingLink, count: int, size: tuple[int, int]) -> ProjectorScreen:
    """Return the screen with robots that have long names."""
    link.known = turns(count, long=True)
    window.refresh()
    if window.panels.projector.isHidden():
        QTest.keyClick(window, Qt.Key.Key_F11)
    window.showNormal()
    window.resize(*size)
    window.refresh()
    QApplication.processEvents()
    return window.panels.projector


def test_a_long_text_is_cut_in_the_middle() -> None:
    for most, shown in ((9, "abcdefghi"), (7, "abc…ghi"), (4, "ab…i"), (2, "a…"), (1, "…"), (0, "…")):
        assert cut_in_middle("abcdefghi", lambda text, most=most: len(text) <= most) == shown  # type: ignore[misc]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("count", [1, 3, 8, 30])
@pytest.mark.parametrize("language", LANGUAGES)
def test_robots_fill_the_screen_and_no_text_leaves_its_robot(
    window: Window, link: RecordingLink, size: tuple[int, int], count: int, language: str
) -> None:
    window.handle(Choose("language", language))
    screen = shown(window, link, count, size)
    room = screen.rect()
    for card in screen.cards:
        place = card.geometry().translated(card.parentWidget().pos())
        assert room.contains(place)
        assert place.width() > room.width() / 6
        check_texts(card)
    last = screen.cards[-1]
    assert last.geometry().bottom() > room.height() * 0.9, "no empty space below"
    assert screen.hint.shown == screen.hint.text()


def check_texts(card: RobotCard) -> None:
    """The parts of a robot lie inside it and do not touch each other; both ends of names are shown."""
    top = [part for part in (card.robot, card.state, card.side, card.left) if part.text()]
    for part in (*top, card.driver, card.waiting):
        assert card.rect().contains(part.geometry()), part.text()
        assert part.shown[-2:] == part.text()[-2:], "the end of a name is shown"
    assert card.robot.geometry().right() < card.left.x()
    for note in (card.side, card.state):
        if note.text():
            assert note.shown == note.text()
    assert card.left.shown == card.left.text()
    assert card.driver.geometry().bottom() < card.waiting.y() + 2


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("size", SIZES[:2])
def test_names_of_up_to_four_robots_have_six_hundredths_of_the_height(
    window: Window, link: RecordingLink, size: tuple[int, int], count: int
) -> None:
    for card in shown(window, link, count, size).cards:
        for part in (card.robot, card.driver, card.waiting):
            assert part.size_px >= 0.06 * size[1]


def test_robots_that_come_and_go_change_the_columns(window: Window, link: RecordingLink) -> None:
    for count in (30, 1, 4):
        screen = shown(window, link, count, SIZES[0])
        assert len(screen.cards) == count
        assert screen.cards[0].driver.text().startswith("Ana")
        columns = {30: 5, 1: 1, 4: 2}[count]
        assert screen.cards[0].width() > screen.width() / (columns + 0.2)
