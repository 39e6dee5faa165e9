"""The buttons of gestures: pictures, presses, and the program that runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_worlds import world
from PyQt5.QtCore import Qt
from PyQt5.QtTest import QTest
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import gestures
from gui.console.state.actions import FOLLOW, NEW, TURN, FollowFace, Play, WriteFile
from gui.console.state.intents import Intent, Theme
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.world import FaceProgress
from gui.console.texts import Texts
from gui.window.widgets.gestures import GesturesPanel
from gui.window.widgets.picture_button import PictureButton

OWN = Path("/home/ana/beatrix-programs/follow_the_face.py")


@pytest.fixture
def panel(qtbot: QtBot) -> GesturesPanel:
    made = GesturesPanel(Texts("en"))
    qtbot.addWidget(made)
    made.show_theme(Theme.LIGHT)
    made.show_view(gestures.view(Memory(Choices()), world(face=FaceProgress(own_file=OWN))))
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
    programs = (FollowFace(NEW, (), program) for program in (FOLLOW, TURN))
    assert given == [*plays, *programs, WriteFile(NEW, OWN, Path())]


def test_every_gesture_has_a_picture_of_its_own(panel: GesturesPanel) -> None:
    seen = set()
    for button in buttons(panel):
        image = button.icon().pixmap(button.iconSize()).toImage()
        assert len({image.pixel(x, y) for x in range(image.width()) for y in range(image.height())}) > 3
        seen.add(bytes(image.constBits().asarray(image.byteCount())))
    assert len(seen) == len(buttons(panel))


def test_the_running_program_is_shown_with_its_file_and_its_last_line(panel: GesturesPanel) -> None:
    face = FaceProgress(running=True, file=OWN, own_file=OWN, line="ValueError: no face")
    panel.show_view(gestures.view(Memory(Choices()), world(face=face)))
    assert (panel.follow.text(), panel.follow.property("running")) == ("End", "yes")
    assert str(OWN) in panel.note.text()
    assert "ValueError: no face" in panel.follow.toolTip()
    panel.show_view(gestures.view(Memory(Choices()), world()))
    follow = panel.follow
    assert (follow.text(), follow.property("running"), panel.note.text()) == ("Follow", "", "")
