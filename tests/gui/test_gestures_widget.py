"""The buttons of gestures: pictures, presses, and the program that runs."""

from __future__ import annotations

import pytest
from gui_worlds import world
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import gestures
from gui.console.state.actions import FOLLOW, NEW, OpenProgram, Play
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Intent, Theme
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.world import ProgramProgress
from gui.console.texts import Texts
from gui.window.widgets.gestures import GesturesPanel
from gui.window.widgets.picture_button import PictureButton


@pytest.fixture
def panel(qtbot: QtBot) -> GesturesPanel:
    made = GesturesPanel(Texts("en"))
    qtbot.addWidget(made)
    made.show_theme(Theme.LIGHT)
    made.show_view(gestures.view(Memory(Choices()), world()))
    made.resize(420, 122)
    made.show()
    return made


def buttons(panel: GesturesPanel) -> tuple[PictureButton, ...]:
    return (*panel.buttons.values(), panel.follow, panel.turn, panel.open)


def test_each_button_reports_its_intent(panel: GesturesPanel) -> None:
    given: list[Intent] = []
    panel.intent.connect(given.append)
    for button in buttons(panel):
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    plays = (Play(NEW, (), gesture=name) for name in GESTURES)
    assert given == [*plays, RunExample("follow"), RunExample("turn"), OpenProgram(FOLLOW)]


def test_every_gesture_has_a_picture_of_its_own(panel: GesturesPanel) -> None:
    seen = set()
    for button in buttons(panel):
        image = button.icon().pixmap(button.iconSize()).toImage()
        assert len({image.pixel(x, y) for x in range(image.width()) for y in range(image.height())}) > 3
        seen.add(bytes(image.constBits().asarray(image.byteCount())))
    assert len(seen) == len(buttons(panel))


def test_the_running_program_is_shown(panel: GesturesPanel) -> None:
    panel.show_view(gestures.view(Memory(Choices()), world(program=ProgramProgress(FOLLOW, running=True))))
    assert (panel.follow.text(), panel.follow.property("running")) == ("End", "yes")
    panel.show_view(gestures.view(Memory(Choices()), world()))
    follow = panel.follow
    assert (follow.text(), follow.property("running")) == ("Follow", "")
