"""STOP and the other keys, with any focus."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from gui_windows import menu_button, whole
from gui_worlds import plan
from present import present
from PyQt5.QtCore import QEvent, QPoint, Qt
from PyQt5.QtGui import QKeyEvent
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink

from gui.console.state.actions import BeginRecording, LookForPorts, Send, SendStop, UseRouter
from gui.console.state.connecting import CloseConnect
from gui.console.state.intents import (
    AddPose,
    AimHead,
    Choose,
    EmergencyStop,
    Intent,
    Jog,
    SendHead,
    Stop,
    Undo,
)
from gui.console.state.world import PlanPhase
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support")  # popups and dialogs without a display
STOP_KEYS = [Qt.Key.Key_Space, Qt.Key.Key_Escape, Qt.Key.Key_Pause]


def a_list(window: Window) -> QWidget:
    """Return the list of the history, after adding a row so that it is shown."""
    window.handle(Jog("short", 1))
    return window.panels.history.list


def a_name(window: Window) -> QWidget:
    """Return the field with the name of a pose."""
    window.handle(AddPose("yes"))
    window.panels.low_area.setCurrentWidget(window.panels.sequence)
    return window.panels.sequence.name


FOCUS: dict[str, Callable[[Window], QWidget]] = {
    "pad": lambda window: window.panels.head.pad,
    "button": lambda window: window.panels.arms.rows["short"].plus,
    "STOP": lambda window: window.panels.stop_bar,
    "number": lambda window: window.panels.arms.increment.box,
    "slider": lambda window: window.panels.arms.speed.slider,
    "check box": lambda window: window.panels.sending.hw,
    "choice": lambda window: window.panels.arms.absolute,
    "list": a_list,
    "robots": lambda window: window.panels.header.robots,
    "tabs": lambda window: window.panels.tabs.tabBar() or window,
    "name": a_name,
}


def focus(qtbot: QtBot, widget: QWidget) -> None:
    widget.setFocus()
    qtbot.waitUntil(widget.hasFocus)


def press(key: Qt.Key, modifiers: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
    """Press a key as the platform does: in the popup, or in the focused widget."""
    QTest.keyClick(under_keys(), key, modifiers)


def under_keys() -> QWidget:
    """Return the widget to which the platform sends keys."""
    found: tuple[QWidget | None, ...] = (
        QApplication.activePopupWidget(),
        QApplication.focusWidget(),
        QApplication.activeWindow(),
    )
    return next(widget for widget in found if widget is not None)


def test_stop_works_with_any_focus(qtbot: QtBot, window: Window, link: RecordingLink, intents: Taken) -> None:
    for place, find in FOCUS.items():
        focus(qtbot, find(window))
        for key in STOP_KEYS:
            intents()
            link.done.clear()
            press(key)
            assert (intents(), [type(action) for action in link.done]) == ([Stop()], [SendStop]), place
    assert window.panels.sequence.name.text() == "yes", "the keys are not typed into the name"


@pytest.mark.parametrize("key", STOP_KEYS)
def test_stop_works_while_a_list_a_menu_or_a_dialog_is_open(
    qtbot: QtBot, window: Window, intents: Taken, key: Qt.Key
) -> None:
    for opens in (window.panels.header.robots.showPopup, window.panels.header.menu_button.click):
        opens()
        assert QApplication.activePopupWidget() is not None
        press(key)
        assert intents() == [Stop()]
        assert QApplication.activePopupWidget() is None
    window.panels.plots.csv.click()
    dialog = present(window.panels.plots.dialog)
    qtbot.waitUntil(lambda: QApplication.activeWindow() is dialog)
    press(key)
    assert intents() == [Stop()]
    assert dialog.isVisible()
    assert not dialog.isModal()


def test_stop_is_sent_when_the_mouse_is_pressed_even_beside_an_open_menu(
    window: Window, intents: Taken
) -> None:
    header, bar = window.panels.header, window.panels.stop_bar
    QTest.mousePress(bar, Qt.MouseButton.LeftButton)
    assert intents() == [Stop()]
    QTest.mouseRelease(bar, Qt.MouseButton.LeftButton)
    header.menu_button.click()
    at = header.menu.mapFromGlobal(bar.mapToGlobal(QPoint(40, 30)))
    QTest.mousePress(header.menu, Qt.MouseButton.LeftButton, pos=at)
    assert intents() == [Stop()]
    assert not header.menu.isVisible()


def test_an_emergency_stop_needs_a_second_press_and_never_hinders_stop(
    window: Window, intents: Taken
) -> None:
    pill, emergency = window.panels.header.pills["hw"], menu_button(window, "hw", "EMERGENCY STOP")
    pill.more.click()
    assert all(whole(button) for button in pill.menu.buttons if not button.isHidden())
    QTest.mouseClick(emergency, Qt.MouseButton.LeftButton)
    assert (intents(), emergency.property("armed")) == ([], "yes")
    assert whole(emergency)
    assert whole(pill.menu.question)
    assert "fall" in pill.menu.question.text()
    QTest.keyClick(emergency, Qt.Key.Key_Space)
    QTest.mousePress(window.panels.stop_bar, Qt.MouseButton.LeftButton)
    assert intents() == [Stop(), Stop()]
    pill.more.click()
    QTest.mouseClick(emergency, Qt.MouseButton.LeftButton)
    QTest.mouseClick(emergency, Qt.MouseButton.LeftButton)
    assert intents() == [EmergencyStop()]


def test_escape_sends_stop_and_closes_what_lies_over_the_window(window: Window, intents: Taken) -> None:
    press(Qt.Key.Key_F1)
    assert window.panels.key_sheet.isVisible()
    press(Qt.Key.Key_Space)
    assert window.panels.key_sheet.isVisible(), "only Esc closes it"
    press(Qt.Key.Key_Escape)
    assert not window.panels.key_sheet.isVisible()
    window.panels.header.menu_button.click()
    press(Qt.Key.Key_Escape)
    assert not window.panels.header.menu.isVisible()
    assert intents() == [Stop(), Stop(), Stop()]
    window.handle(LookForPorts())
    assert window.panels.connect_sheet.isVisible()
    press(Qt.Key.Key_Escape)
    assert not window.panels.connect_sheet.isVisible()
    assert intents() == [LookForPorts(), Stop(), CloseConnect()]


def test_a_key_that_is_held_counts_once(qtbot: QtBot, window: Window, intents: Taken) -> None:
    focus(qtbot, window.panels.arms.rows["short"].plus)
    for key in (*STOP_KEYS, Qt.Key.Key_Return, Qt.Key.Key_F1):
        press(key)
        first, shown = intents(), window.panels.key_sheet.isVisible()
        again = QKeyEvent(QEvent.Type.KeyPress, key, Qt.KeyboardModifier.NoModifier, "", autorep=True)
        QApplication.sendEvent(under_keys(), again)
        assert len(first) == (key != Qt.Key.Key_F1)
        assert intents() == []
        assert window.panels.key_sheet.isVisible() == shown


def test_ctrl_z_undoes_ctrl_r_records_and_enter_sends(
    qtbot: QtBot, window: Window, link: RecordingLink, intents: Taken
) -> None:
    for place in ("number", "list", "pad"):
        focus(qtbot, FOCUS[place](window))
        intents()
        for key in (Qt.Key.Key_Z, Qt.Key.Key_R):
            press(key, Qt.KeyboardModifier.ControlModifier)
        assert intents() == [Undo(), BeginRecording()], place
    press(Qt.Key.Key_Right)
    intents()
    press(Qt.Key.Key_Return)
    assert intents() == [SendHead()]
    assert isinstance(link.done[-1], Send)


def test_an_address_is_typed_and_space_is_stop_meanwhile(window: Window, link: RecordingLink) -> None:
    window.handle(LookForPorts())
    address = window.panels.connect_sheet.router.address
    address.setFocus()
    address.selectAll()
    QTest.keyClicks(address, "lab")
    QTest.keyClick(address, Qt.Key.Key_Space)
    QTest.keyClick(address, Qt.Key.Key_Return)
    stop, use = link.done[-2:]
    assert isinstance(stop, SendStop)
    assert use == UseRouter("tcp/lab:7447")
    assert address.text() == "lab", "it can be corrected"


STEPS = [
    (Qt.Key.Key_Left, (0.0, 0.0, -1.0)),
    (Qt.Key.Key_Right, (0.0, 0.0, 1.0)),
    (Qt.Key.Key_Up, (0.0, -1.0, 0.0)),
    (Qt.Key.Key_Down, (0.0, 1.0, 0.0)),
    (Qt.Key.Key_PageUp, (1.0, 0.0, 0.0)),
    (Qt.Key.Key_PageDown, (-1.0, 0.0, 0.0)),
]


@pytest.mark.parametrize("facing", [True, False])
def test_arrow_keys_move_the_target_as_the_picture_shows_it(
    qtbot: QtBot, window: Window, intents: Taken, *, facing: bool
) -> None:
    window.handle(Choose("facing", facing))
    focus(qtbot, window.panels.head.pad)
    for key, (yaw, pitch, roll) in STEPS:
        step = (-yaw, pitch, -roll) if facing else (yaw, pitch, roll)
        for modifier, size in (
            (Qt.KeyboardModifier.NoModifier, 1.0),
            (Qt.KeyboardModifier.ShiftModifier, 5.0),
        ):
            window.handle(AimHead(0.0, 0.0, 0.0))
            intents()
            press(key, modifier)
            assert intents() == [AimHead(*(size * angle + 0.0 for angle in step))]


def test_the_focus_of_a_button_that_vanishes_goes_to_stop(
    qtbot: QtBot, window: Window, link: RecordingLink
) -> None:
    """Enter must not press Record or a tab, which Qt would choose."""
    abort, here = window.panels.sending.abort, link.known
    link.known = replace(here, plan=plan(PlanPhase.LEADING, 1.0).plan)
    window.refresh()
    focus(qtbot, abort)
    link.known = here
    window.refresh()
    assert window.panels.stop_bar.hasFocus()
