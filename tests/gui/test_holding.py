"""Held + and -: what is sent while a button is held; `test_robots_in_window.py` holds one with real robots."""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec
import pytest
from gui_worlds import BOTH, state_after, world
from PyQt5.QtCore import QEvent, Qt
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from recording_link import WatchedState

from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery
from gui.console.link.jogging import BRAKE_S
from gui.console.state.actions import Hold, Outcome, Release
from gui.console.state.arms import AHEAD_S, FASTEST_DEG_S, HoldArm, ReleaseArm, Steer, jog_query
from gui.console.state.intents import Choose, Stop
from gui.console.state.state import State
from gui.page.hub import DEAD_MAN_S
from gui.window.widgets.arms import HoldButton
from gui.window.window import Window

LEFT = Qt.MouseButton.LeftButton


def test_all_heartbeats_of_a_press_are_one_row() -> None:
    state = state_after(Choose("speed", 30.0))
    first, second = (state.handle(HoldArm("short", -1), world()) for _ in range(2))
    assert first == second == [Hold(1, (("short", -1.0),), 30.0, ("sim",))]
    assert state.handle(ReleaseArm(), world()) == [Release(1)]
    assert state.handle(ReleaseArm(), world()) == []
    assert state.handle(HoldArm("short", -1), world()) == [Hold(2, (("short", -1.0),), 30.0, ("sim",))]
    assert len(state.view(world()).history) == 2


def test_a_refused_press_is_refused_once() -> None:
    state = State()
    state.handle(Choose("sim", value=False), world())
    assert state.handle(HoldArm("short", 1), world()) == []
    assert state.handle(HoldArm("short", 1), world()) == []
    assert state.handle(ReleaseArm(), world()) == []
    assert not state.view(world()).history


def test_the_row_of_a_hold_gets_the_angles_at_rest() -> None:
    state = State()
    state.handle(HoldArm("long", 1), world())
    state.handle(ReleaseArm(), world())
    state.report(Outcome(1, "sim", accepted=True, done=True))
    state.follow(world())
    assert "relative" not in state.view(world()).code.text


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_panel_says_that_both_move_at_once_while_a_button_is_held(language: str) -> None:
    state = state_after(Choose("language", language), BOTH)
    texts, idle = state.choices.texts, state.view(world()).sending
    state.handle(HoldArm("short", 1), world())
    held = state.view(world())
    assert (held.sending.title, held.sending.text) == (texts("sending.held"), texts("sending.held_text"))
    assert held.arms.rows[0].plus.tooltip.endswith(texts("arm.hold_both"))
    state.handle(ReleaseArm(), world())
    assert state.view(world()).sending == idle
    state.handle(HoldArm("short", 1), world())
    state.handle(Stop(), world())
    assert state.view(world()).sending == idle, "after STOP nothing moves although the button is held"


@pytest.mark.parametrize(("part", "moved"), [("short", 1), ("all", 3)])
def test_the_goal_of_a_hold_lies_ahead_at_a_limited_speed(part: str, moved: int) -> None:
    assert BRAKE_S < DEAD_MAN_S < AHEAD_S <= 0.5
    query = jog_query(((part, 1.0),), 90.0, AHEAD_S)
    assert isinstance(query, MotionQuery)
    angles = [query.position.x, query.position.y, query.position.z]
    assert sum(math.isclose(math.degrees(angle), FASTEST_DEG_S * AHEAD_S) for angle in angles) == moved


def test_a_stick_turns_all_axes_at_once_each_with_its_share_of_the_speed() -> None:
    query = jog_query((("yaw", 0.5), ("pitch", 0.0), ("roll", -1.0)), 20.0, 0.5)
    assert isinstance(query, PoseQuery)
    turned = [math.degrees(angle) for angle in (query.yaw, query.pitch, query.roll)]
    assert turned == pytest.approx([5.0, 0.0, -10.0])
    assert query.speed == pytest.approx(math.radians(20.0))


def test_changes_of_a_stick_are_one_row_and_a_stick_at_rest_begins_none() -> None:
    state = State()
    assert state.handle(Steer(0.0, 0.0, 0.0), world()) == []
    (first,) = state.handle(Steer(0.5, 0.0, 0.0), world())
    (second,) = state.handle(Steer(0.0, -1.0, 0.0), world())
    assert isinstance(first, Hold)
    assert second == msgspec.structs.replace(first, shares=(("yaw", 0.0), ("pitch", -1.0), ("roll", 0.0)))
    assert len(state.view(world()).history) == 1


def test_keys_turn_the_head_together_until_the_last_one_is_released(
    qtbot: QtBot, window: Window, state: WatchedState
) -> None:
    pad = window.panels.head.pad
    pad.setFocus()
    QTest.keyPress(pad, Qt.Key.Key_A)
    QTest.keyPress(pad, Qt.Key.Key_W)
    qtbot.waitUntil(lambda: state.intents.count(Steer(-1.0, -1.0, 0.0)) > 1, timeout=5000)
    QTest.keyRelease(pad, Qt.Key.Key_A)
    assert Steer(0.0, -1.0, 0.0) == state.intents[-1]
    QApplication.sendEvent(pad, QEvent(QEvent.Type.WindowDeactivate))
    assert ReleaseArm() in state.intents


@pytest.mark.parametrize(
    "end",
    [
        lambda button: QTest.mouseRelease(button, LEFT),
        lambda button: QApplication.sendEvent(button, QEvent(QEvent.Type.WindowDeactivate)),
        lambda button: button.hide(),
    ],
    ids=["release", "another window", "hidden"],
)
def test_a_hold_ends_when_the_button_can_no_longer_be_released(
    qtbot: QtBot, window: Window, state: WatchedState, end: Callable[[HoldButton], object]
) -> None:
    button = window.panels.arms.rows["all"].plus
    QTest.mousePress(button, LEFT)
    qtbot.waitUntil(lambda: HoldArm("all", 1) in state.intents)
    end(button)
    assert state.intents[-1] == ReleaseArm()
    QTest.mouseRelease(button, LEFT)
    button.show()
