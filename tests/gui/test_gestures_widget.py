"""The buttons of gestures: pictures, presses, and their arrangement in a wide and in a narrow panel."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

import pytest
from gui_worlds import world
from PyQt5.QtCore import Qt
from PyQt5.QtGui import QImage
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state import gestures
from gui.console.state.actions import NEW, CopyProgram, FollowFace, Play
from gui.console.state.intents import Intent, Theme
from gui.console.state.memory import Memory
from gui.console.state.saved import Choices
from gui.console.state.world import FaceProgress
from gui.console.texts import Texts
from gui.window.theme import apply_theme, style_of
from gui.window.widgets.gestures import GesturesPanel, PictureButton

OWN = Path("/home/ana/beatrix-programs/follow_the_face.py")
NARROW_PX, WIDE_PX = 420, 1000
"""Width of the middle column of a small and of a large window."""


class Show(Protocol):
    """Shows a panel of a width, and returns it once its buttons have their places."""

    def __call__(
        self, theme: Theme, code: str, width: int, face: FaceProgress | None = None
    ) -> GesturesPanel: ...


@pytest.fixture
def show(qtbot: QtBot) -> Show:
    kept = []

    def shown(theme: Theme, code: str, width: int, face: FaceProgress | None = None) -> GesturesPanel:
        panel, outer = GesturesPanel(Texts(code)), QWidget()
        kept.append(outer)
        qtbot.addWidget(outer)
        layout = QVBoxLayout(outer)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(panel)
        apply_theme(outer, style_of(theme))
        panel.show_theme(theme)
        now = world(face=face or FaceProgress(own_file=OWN))
        panel.show_view(gestures.view(Memory(Choices(language=code)), now))
        outer.resize(width, style_of(theme).px(122))
        outer.show()
        qtbot.waitExposed(outer)
        rows = 2 if width == NARROW_PX else 1
        qtbot.waitUntil(lambda: len({button.y() for button in buttons(panel)}) == rows)
        return panel

    return shown


def buttons(panel: GesturesPanel) -> tuple[PictureButton, ...]:
    return (*panel.buttons.values(), panel.follow, panel.open)


def picture(button: PictureButton) -> QImage:
    return button.grab().toImage()


@pytest.mark.parametrize("by_key", [False, True])
def test_each_button_reports_its_intent(show: Show, *, by_key: bool) -> None:
    panel = show(Theme.DARK, "en", WIDE_PX)
    given: list[Intent] = []
    panel.intent.connect(given.append)
    for button in buttons(panel):
        if by_key:
            QTest.keyClick(button, Qt.Key.Key_Space)
        else:
            QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    gestures = (Play(NEW, (), gesture=name) for name in GESTURES)
    assert given == [*gestures, FollowFace(NEW, ()), CopyProgram(NEW, OWN)]


def test_every_gesture_has_a_picture_of_its_own(show: Show) -> None:
    panel = show(Theme.LIGHT, "en", NARROW_PX)
    side = min(
        min(button.width(), button.height() - button.fontMetrics().height()) for button in buttons(panel)
    )
    seen = set()
    for button in buttons(panel):
        image = picture(button).copy((button.width() - side) // 2, 3, side, side - 6)
        assert len({image.pixel(x, y) for x in range(image.width()) for y in range(image.height())}) > 3
        seen.add(bytes(image.constBits().asarray(image.byteCount())))
    assert len(seen) == len(buttons(panel))


def test_the_running_program_is_shown_with_its_file_and_its_last_line(show: Show) -> None:
    face = FaceProgress(running=True, file=OWN, own_file=OWN, line="ValueError: no face")
    panel = show(Theme.DARK, "en", WIDE_PX, face)
    assert (panel.follow.text(), panel.follow.property("running")) == ("End", "yes")
    assert str(OWN) in panel.note.text()
    assert "ValueError: no face" in panel.follow.toolTip()
    panel.show_view(gestures.view(Memory(Choices()), world()))
    assert (panel.follow.text(), panel.follow.property("running"), panel.note.text()) == (
        "Follow",
        "",
        "",
    )
