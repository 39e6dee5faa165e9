"""The room beside the head: when it is shown and received, and dragging the person."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import pytest
from gui_worlds import absent, robot, world
from hypothesis import given
from hypothesis import strategies as st
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from gui.console.state.actions import TURN, LetSpeak, MovePerson, Watch
from gui.console.state.intents import Choose, Intent, Tab, Theme
from gui.console.state.state import State
from gui.console.state.world import Person, ProgramProgress
from gui.console.texts import Texts
from gui.window.widgets.head3d_room import NEAREST, REACH, Floor, Room

PERSON = Person(1.0, 0.5, 0.16)
RUNS = ProgramProgress(TURN, running=True, sides=("hw", "sim"))
HIDDEN = [Watch()]


def shown(side: str) -> list[Intent]:
    return [Watch(cameras=frozenset({(side, "left")}), person=True)]


def test_the_room_is_received_exactly_while_it_is_visible() -> None:
    state, now = State(), world(person=PERSON)
    assert (state.follow(now), state.view(now).room) == ([], None)
    assert state.handle(Choose("room", value=True), now) == shown("sim")
    assert present(state.view(now).room).person == PERSON
    assert state.handle(Choose("tab", Tab.PLOTS), now) == HIDDEN
    assert state.handle(Choose("tab", Tab.HEADS), now) == shown("sim")
    assert state.handle(Choose("room", value=False), now) == HIDDEN


def test_a_program_shows_the_room_with_its_own_eye_until_it_ends() -> None:
    state, runs = State(), world(program=RUNS)
    assert state.follow(runs) == shown("hw")
    assert state.follow(runs) == []
    assert present(state.view(runs).room).eye.side == "hw"
    assert state.follow(world()) == HIDDEN


def test_nobody_is_looked_for_without_a_simulation() -> None:
    state = State()
    (watch,) = state.follow(world(absent("sim"), robot("hw"), program=RUNS))
    assert isinstance(watch, Watch)
    assert not watch.person


@given(
    azimuth=st.floats(0, 2 * math.pi),
    way=st.floats(0, 2 * math.pi),
    far=st.floats(NEAREST, REACH),
    wide=st.floats(100, 400),
)
def test_a_place_on_the_map_is_the_place_that_was_drawn_there(
    azimuth: float, way: float, far: float, wide: float
) -> None:
    floor, (x, y) = Floor(azimuth, wide, 0.8 * wide), (far * math.cos(way), far * math.sin(way))
    assert floor.ground(floor.place(x, y)) == pytest.approx((x, y), abs=1e-6)
    beyond = floor.ground(floor.place(3 * x, 3 * y))
    assert math.hypot(*beyond) <= REACH + 1e-6


@pytest.fixture
def room(qtbot: QtBot) -> Iterator[Room]:
    """The room over a picture of 600 x 400, seen from the front."""
    picture = QWidget()
    qtbot.addWidget(picture)
    made, state, now = Room(Texts("en"), picture), State(), world(person=PERSON)
    made.show_theme(Theme.LIGHT)
    picture.resize(600, 400)
    picture.show()
    assert made.isHidden()
    state.handle(Choose("room", value=True), now)
    made.show_view(state.view(now).room)
    assert made.isVisible()
    yield made
    picture.close()


def test_a_press_an_arrow_and_the_button_move_the_person_and_let_it_speak(room: Room) -> None:
    taken: list[Intent] = []
    room.intent.connect(taken.append)
    at = room.map.floor.place(1.2, -0.4).toPoint()
    QTest.mouseClick(room.map, Qt.MouseButton.LeftButton, pos=QPoint(at))
    QTest.keyClick(room.map, Qt.Key.Key_Left)
    room.speak.click()
    placed, stepped, speaks = taken
    assert isinstance(placed, MovePerson)
    assert (placed.x, placed.y, placed.z) == pytest.approx((1.2, -0.4, PERSON.z), abs=0.03)
    assert isinstance(stepped, MovePerson)
    # From the front, the left of the picture is the robot's right.
    assert stepped.x == pytest.approx(PERSON.x)
    assert stepped.y < PERSON.y
    assert speaks == LetSpeak(on=True)


def test_the_map_looks_different_for_each_person(room: Room) -> None:
    people = (None, PERSON, Person(-1.0, 0.5, 0.16), Person(1.0, 0.5, 0.16, speaks=True))
    seen = set()
    for person in people:
        room.map.show_view(replace(present(room._view), person=person))
        seen.add(room.map.grab().toImage().bits().asstring(room.map.width() * room.map.height() * 4))
    assert len(seen) == len(people)
