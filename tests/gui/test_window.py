"""The window with link, state and widgets."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from gui_views import posed
from gui_windows import menu_button, reveal
from PyQt5.QtCore import Qt, QTimer
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink

from beatrix_zenoh.client.degrees import HeadAngles
from beatrix_zenoh.contract._generated.messages import Command
from gui.console.state.actions import ChooseRobot
from gui.console.state.intents import Choose, Intent, Jog, RunCommand, Stop, Theme
from gui.window.panels import PAGES
from gui.window.run import Bridge, errors_shown
from gui.window.theme import style_of
from gui.window.widgets.header import ROBOT_PX
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
LEFT = Qt.MouseButton.LeftButton
POPUPS = pytest.mark.qt_log_ignore("This plugin does not support")  # popups without a display


def test_the_window_shows_the_world_of_the_link_periodically(
    qtbot: QtBot, window: Window, link: RecordingLink
) -> None:
    link.known = replace(link.known, sim=posed("sim", (33.3, 0.0, 0.0), HeadAngles(44.0, 0.0, 0.0)))
    row = window.panels.arms.rows["short"]
    qtbot.waitUntil(lambda: row.sim.text() == "33.3°")
    assert window.panels.head.numbers["sim", "yaw"].text() == "44.0°"


@POPUPS
def test_disabling_the_hardware_needs_a_second_press(window: Window, intents: Taken) -> None:
    menu, button = window.panels.header.pills["hw"].menu, menu_button(window, "hw", "Disable")
    window.panels.header.pills["hw"].more.click()
    assert menu.isVisible()
    QTest.mouseClick(button, LEFT)
    assert intents() == []
    assert button.text() == "Disable?"
    assert "sinks" in menu.question.text()
    assert menu.question.isVisible()
    assert menu.question.height() >= menu.question.heightForWidth(menu.question.width()), "all of it is shown"
    menu.close()
    window.panels.header.pills["hw"].more.click()
    assert button.text() == "Disable", "a closed menu forgets its question"
    QTest.mouseClick(button, LEFT)
    assert intents() == []
    QTest.mouseClick(button, LEFT)
    assert intents() == [RunCommand(Command.ENABLE, value=False, side="hw")]
    assert button.text() == "Disable"
    assert not menu.isVisible()


@POPUPS
def test_enter_presses_a_button_of_a_menu_and_space_is_stop(window: Window, intents: Taken) -> None:
    pill = window.panels.header.pills["sim"]
    pill.more.click()
    QTest.keyClick(pill.menu.buttons[0], Qt.Key.Key_Return)
    assert intents() == [RunCommand(Command.CALIBRATE, side="sim")]
    pill.more.click()
    QTest.keyClick(pill.menu.buttons[0], Qt.Key.Key_Space)
    assert intents() == [Stop()]
    assert not pill.menu.isVisible()


def test_a_theme_applies_to_all_widgets(window: Window) -> None:
    for theme in (Theme.LIGHT, Theme.PROJECTOR, Theme.DARK):
        window.handle(Choose("theme", theme))
        colours = style_of(theme)
        centre = window.grab().toImage().pixelColor(2, 100)
        assert centre.name() == colours.ground
        stop = window.panels.stop_bar
        assert window.grab().toImage().pixelColor(stop.width() // 2, stop.y() + 8).name() == colours.stop


def test_the_language_changes_while_the_window_runs(
    qtbot: QtBot, window: Window, link: RecordingLink, intents: Taken
) -> None:
    old = window.panels
    old.header.choices["de"].trigger()
    assert intents() == [Choose("language", "de")]
    assert window.panels is not old
    assert window.panels.sending.send.text() == "Senden"
    assert window.panels.arms.increment.box.text() == "5,0 °"
    QTest.mouseClick(window.panels.arms.rows["short"].plus, LEFT)
    assert intents() == [Jog("short", 1)]
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert intents() == [Stop()]
    qtbot.waitUntil(window.panels.isVisible)


@pytest.mark.parametrize("size", [(1366, 768), (1024, 560)])
def test_another_language_keeps_tabs_camera_curves_and_row(
    qtbot: QtBot, window: Window, size: tuple[int, int]
) -> None:
    window.resize(*size)
    qtbot.waitUntil(lambda: window.panels.width() == size[0])
    QTest.mouseClick(window.panels.arms.rows["short"].plus, LEFT)
    old = window.panels
    for page in (old.history, old.code, old.sequence, old.plots):
        reveal(page)
    old.head3d.views["front"].click()
    old.history.list.setCurrentRow(0)
    old.plots.bar.choices["sim"].setChecked(False)
    old.plots.show_span(5.0)
    old.plots.pause(on=True)
    shown = old.plots.plots["short"].lines[0].getData()
    pages = {name for name in PAGES if getattr(old, name).isVisible()}
    assert "plots" in pages
    old.header.choices["de"].trigger()
    new = window.panels
    assert new is not old
    qtbot.waitUntil(new.isVisible)
    assert {name for name in PAGES if getattr(new, name).isVisible()} == pages
    assert new.head3d.views["front"].isChecked()
    assert new.history.list.currentRow() == 0
    assert new.history.repeat.isEnabled()
    assert new.plots.bar.pause.isChecked()
    assert new.plots.bar.spans[5].isChecked()
    assert not new.plots.bar.chosen("sim")
    assert np.array_equal(new.plots.plots["short"].lines[0].getData(), shown)


@pytest.mark.qt_no_exception_capture
def test_an_error_in_a_slot_is_shown_and_the_window_continues(
    qtbot: QtBot, window: Window, intents: Taken, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise ValueError("a bug of the window")

    hooks = sys.excepthook, threading.excepthook
    with errors_shown(window.show_error):
        QTimer.singleShot(0, fail)
        qtbot.waitUntil(window.panels.trouble.isVisible)
        assert "a bug of the window" in window.panels.trouble.text.text()
        assert "a bug of the window" in caplog.text
        QTest.keyClick(window, Qt.Key.Key_Space)
        assert intents() == [Stop()]
        QTest.mouseClick(window.panels.trouble.close_button, LEFT)
        assert not window.panels.trouble.isVisible()
    assert (sys.excepthook, threading.excepthook) == hooks


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_an_error_of_another_thread_is_shown(
    qtbot: QtBot, window: Window, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise ValueError("a bug of a thread")

    bridge = Bridge()
    with errors_shown(lambda text: bridge.post(lambda: window.show_error(text))):
        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
        qtbot.waitUntil(window.panels.trouble.isVisible)
    assert "a bug of a thread" in window.panels.trouble.text.text()
    bridge.close()


def test_nothing_is_drawn_while_nothing_changes(qtbot: QtBot, window: Window) -> None:
    """An unchanged window leaves the processor time to the simulation."""
    painted: list[str] = []
    pad = window.panels.head.pad
    window.panels.tabs.setCurrentWidget(window.panels.eyes)
    for _ in range(3):
        window.refresh()
        QApplication.processEvents()
    original = type(pad).paintEvent

    def counting(self: object, event: object) -> None:
        painted.append("pad")
        original(pad, event)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(pad), "paintEvent", counting)
        for _ in range(10):
            window.refresh()
            QApplication.processEvents()
        assert painted == []
        pad.update()
        qtbot.waitUntil(lambda: painted == ["pad"])


def test_another_robot_is_chosen_by_keyboard(qtbot: QtBot, window: Window, intents: Taken) -> None:
    robots = window.panels.header.robots
    robots.setFocus()
    qtbot.waitUntil(robots.hasFocus)
    QTest.keyClick(robots, Qt.Key.Key_Down)
    assert intents() == [ChooseRobot("bea2")]


def test_a_name_of_32_letters_leaves_room_for_the_pills(
    qtbot: QtBot, window: Window, link: RecordingLink
) -> None:
    name, header = "robot-of-the-third-row-at-window", window.panels.header
    link.known = replace(link.known, robot=name, names=(name,))
    qtbot.waitUntil(lambda: header.robots.currentText() == name)
    assert header.robots.width() <= ROBOT_PX
    assert name in header.robots.toolTip()
    popup = header.robots.view()
    assert popup is not None
    assert popup.minimumWidth() > header.robots.fontMetrics().horizontalAdvance(name)


@pytest.mark.qt_log_ignore("This plugin does not support")  # popups without a display
def test_the_list_of_41_robots_scrolls(qtbot: QtBot, window: Window, link: RecordingLink) -> None:
    names = tuple(f"robot-{number:02d}" for number in range(1, 42))
    header = window.panels.header
    link.known = replace(link.known, robot=names[0], names=names)
    qtbot.waitUntil(lambda: header.robots.count() == 41)
    header.robots.showPopup()
    popup = header.robots.view()
    assert popup is not None
    bar = popup.verticalScrollBar()
    assert bar is not None
    qtbot.waitUntil(bar.isVisible)
    assert bar.maximum() > 0
    header.robots.hidePopup()
