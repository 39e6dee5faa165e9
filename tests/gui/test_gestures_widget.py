"""The buttons of gestures: pictures, presses, menus, the form, and the program that runs."""

from __future__ import annotations

import pytest
from gui_worlds import world
from present import present
from PyQt5.QtCore import QPoint, Qt
from PyQt5.QtTest import QTest
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract.errors import wrong_usage
from gui.console.state import gestures
from gui.console.state.actions import FOLLOW, NEW, Play
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Intent, SaveGesture, Theme
from gui.console.state.memory import Memory
from gui.console.state.own_gestures import EMOJI, DeleteGesture, OpenGesture
from gui.console.state.saved import Choices
from gui.console.state.world import OwnGesture, ProgramProgress, World
from gui.console.texts import Texts
from gui.window.widgets.gestures import GesturesPanel
from gui.window.widgets.picture_button import PictureButton

LEFT = Qt.MouseButton.LeftButton
WINK = OwnGesture("wink", "😜", "")
BROKEN = OwnGesture("broken", "", "", wrong_usage("broken.csv, line 3: t_s is empty."))


@pytest.fixture
def panel(qtbot: QtBot) -> GesturesPanel:
    made = GesturesPanel(Texts("en"))
    qtbot.addWidget(made)
    made.show_theme(Theme.LIGHT)
    seen(made, world(gestures=(WINK, BROKEN)))
    made.resize(660, 122)
    made.show()
    return made


@pytest.fixture
def reported(panel: GesturesPanel) -> list[Intent]:
    given: list[Intent] = []
    panel.intent.connect(given.append)
    return given


def seen(panel: GesturesPanel, now: World) -> None:
    panel.show_view(gestures.view(Memory(Choices()), now))


def buttons(panel: GesturesPanel) -> tuple[PictureButton, ...]:
    return (*panel.buttons.values(), panel.follow, panel.turn)


def test_each_button_reports_its_intent(panel: GesturesPanel, reported: list[Intent]) -> None:
    for button in buttons(panel):
        QTest.mouseClick(button, LEFT)
    plays = (Play(NEW, (), gesture=name) for name in GESTURES)
    assert reported == [*plays, RunExample("follow"), RunExample("turn")]


def test_every_gesture_has_a_picture_of_its_own(panel: GesturesPanel) -> None:
    pictures = set()
    for button in buttons(panel):
        image = button.icon().pixmap(button.iconSize()).toImage()
        assert len({image.pixel(x, y) for x in range(image.width()) for y in range(image.height())}) > 3
        pictures.add(bytes(image.constBits().asarray(image.byteCount())))
    assert len(pictures) == len(buttons(panel))


def test_the_running_program_is_shown(panel: GesturesPanel) -> None:
    for running, shown in ((True, ("End", "yes")), (False, ("Follow", ""))):
        seen(panel, world(program=ProgramProgress(FOLLOW, running)))
        assert (panel.follow.text(), panel.follow.property("running")) == shown


def test_a_sector_of_the_wheel_is_a_button(panel: GesturesPanel) -> None:
    wheel = panel.wheel
    middle = wheel.middle.geometry().center()
    for button in wheel.buttons.values():
        towards = button.geometry().center() - middle
        for share in (0.9, 1.0, 1.1):
            assert wheel.childAt(middle + towards * share) is button
    assert wheel.childAt(middle) is wheel.middle
    assert wheel.childAt(QPoint(1, 1)) is None


def test_a_gesture_of_the_user_has_a_button_with_a_menu(panel: GesturesPanel, reported: list[Intent]) -> None:
    assert not panel.fetch.isVisible(), "there is no class"
    assert "line 3" in panel.own["broken"].toolTip()
    QTest.mouseClick(panel.own["wink"], LEFT, pos=QPoint(10, 10))
    edit, rename, delete = present(panel.own["wink"].menu()).actions()
    for entry in (edit, delete, rename):
        entry.trigger()
    panel.form.name.setText("nod")
    QTest.mouseClick(panel.form.save, LEFT)
    assert reported == [
        Play(NEW, (), gesture="wink"),
        OpenGesture("wink"),
        DeleteGesture("wink"),
        SaveGesture("nod", "😜", old="wink"),
    ]


def test_a_saved_gesture_gets_the_focus_when_its_file_is_there(
    panel: GesturesPanel, reported: list[Intent]
) -> None:
    panel.ask(SaveGesture("", ""))
    panel.form.name.setText("nod")
    panel.form.emoji.setCurrentRow(3)
    QTest.mouseClick(panel.form.save, LEFT)
    assert reported == [SaveGesture("nod", EMOJI[3])]
    seen(panel, world(gestures=(WINK, OwnGesture("nod", EMOJI[3], ""))))
    assert panel.focusWidget() is panel.own["nod"]
