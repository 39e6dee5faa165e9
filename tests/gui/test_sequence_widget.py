"""The sequence editor used with mouse and keyboard; its decisions are tested in `test_sequence.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from gui_windows import drag
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink, WatchedState

from gui.console.state.intents import (
    AimHead,
    Choose,
    DeletePose,
    DuplicatePose,
    Intent,
    MovePose,
    SetDuration,
    UndoSequence,
)
from gui.console.state.music import SetNote
from gui.console.state.saved import Saved, SavedPose
from gui.window.widgets.sequence import Strip
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
LEFT, CONTROL = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ControlModifier
POSES = (
    SavedPose("nod", 0.0, 0.0, 0.0, 1.0),
    SavedPose("left", 30.0, 30.0, 30.0, 2.0),
    SavedPose("far", -90.0, -90.0, -90.0, 0.5),
)


@pytest.fixture
def state() -> WatchedState:
    return WatchedState(Saved(poses=POSES))


@pytest.fixture
def strip(window: Window, intents: Taken) -> Strip:
    window.refresh()
    window.panels.low_area.setCurrentWidget(window.panels.sequence)
    intents()
    return window.panels.sequence.strip


def names(state: WatchedState) -> list[str]:
    return [pose.name for pose in state.saved.poses]


DRAGS = [
    (0, 2.1, ["left", "nod", "far"]),
    (0, 2.9, ["left", "far", "nod"]),
    (2, 0.1, ["far", "nod", "left"]),
    (2, 0.9, ["nod", "far", "left"]),
    (1, 1.4, ["nod", "left", "far"]),
]
"""A card, how far it is dragged (1 is the left edge of the second card), and the order then."""


def test_a_dragged_card_is_put_between_others(
    window: Window, strip: Strip, state: WatchedState, intents: Taken
) -> None:
    for number, where, order in DRAGS:
        start, step = strip.card(number).center(), strip.card(1).x() - strip.card(0).x()
        drag(strip.viewport(), start, QPoint(strip.card(0).x() + round(where * step), start.y()))
        window.refresh()
        assert names(state) == order
        assert strip.cards[strip.currentRow()].name == POSES[number].name, "it stays selected"
        if any(isinstance(intent, MovePose) for intent in intents()):
            window.handle(UndoSequence())


def test_a_click_makes_the_pose_the_target_and_sends_nothing(
    window: Window, strip: Strip, intents: Taken
) -> None:
    QTest.mouseClick(strip.viewport(), LEFT, pos=strip.card(1).center())
    (aim,) = intents()
    assert isinstance(aim, AimHead)
    assert (aim.yaw, aim.pitch, aim.roll) == pytest.approx((30.0, 0.0, 0.0), abs=1e-6)
    window.refresh()
    assert window.panels.sequence.name.text() == "left"
    assert window.panels.sequence.duration.value() == 2.0


def test_the_keyboard_selects_moves_uses_and_deletes(
    qtbot: QtBot, window: Window, strip: Strip, state: WatchedState, intents: Taken
) -> None:
    strip.setFocus()
    qtbot.waitUntil(strip.hasFocus)
    QTest.keyClick(strip, Qt.Key.Key_Right)
    assert (strip.currentRow(), intents()) == (1, [])
    QTest.keyClick(strip, Qt.Key.Key_Left, CONTROL)
    assert intents() == [MovePose("left", 0)]
    for _ in range(2):
        window.refresh()
        QTest.keyClick(strip, Qt.Key.Key_Right, CONTROL)
    window.refresh()
    assert names(state) == ["nod", "far", "left"]
    QTest.keyClick(strip, Qt.Key.Key_Return)
    assert isinstance(intents()[-1], AimHead)
    QTest.keyClick(strip, Qt.Key.Key_Delete)
    assert intents() == [DeletePose("left")]
    window.refresh()
    assert strip.cards[strip.currentRow()].name == "far"
    QTest.mouseClick(window.panels.sequence.undo, LEFT)
    assert intents() == [UndoSequence()]
    window.refresh()
    assert names(state) == ["nod", "far", "left"]
    assert strip.cards[strip.currentRow()].name == "left", "the restored one"


def test_a_duration_is_typed_where_it_is_too_short_and_a_play_does_not_disturb(
    window: Window, strip: Strip, link: RecordingLink, intents: Taken
) -> None:
    panel = window.panels.sequence
    card = strip.cards[2]
    assert (card.duration, card.problem) == ("≥ 2.0 s", "needs 2.0 s or more")
    strip.setCurrentRow(2)
    panel.duration.setFocus()
    panel.duration.selectAll()
    QTest.keyClicks(panel.duration, "2.")
    link.known = replace(link.known, playing="poses", playing_pose=1)
    window.refresh()
    QTest.keyClicks(panel.duration, "5")
    QTest.keyClick(panel.duration, Qt.Key.Key_Return)
    assert intents() == [SetDuration("far", 2.5)]
    link.known = replace(link.known, playing="")
    window.refresh()
    assert (strip.cards[2].duration, strip.cards[2].problem) == ("2.5 s", "")
    assert "5.5 s" in panel.play.toolTip()


def test_loop_and_copy_report_their_intents(window: Window, strip: Strip, intents: Taken) -> None:
    panel = window.panels.sequence
    QTest.mouseClick(panel.loop, LEFT, pos=QPoint(8, panel.loop.height() // 2))
    QTest.mouseClick(panel.duplicate, LEFT)
    assert intents() == [Choose("loop", value=True), DuplicatePose("nod")]


def test_a_tone_and_the_switch_of_all_sounds_are_in_menus(
    window: Window, strip: Strip, state: WatchedState, intents: Taken
) -> None:
    panels = window.panels
    strip.setCurrentRow(1)
    panels.sequence.music.notes[3].trigger()
    panels.header.choices["sounds"].trigger()
    assert intents() == [SetNote("left", 3), Choose("sounds", value=False)]
    window.refresh()
    assert present(strip.item(1)).text().endswith("2.0 s e'")
    assert not panels.header.choices["sounds"].isChecked()
