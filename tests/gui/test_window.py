"""The window with link, state and widgets."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable

import pytest
from PyQt5.QtCore import Qt, QTimer
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from gui.console.state.actions import ChooseRobot
from gui.console.state.intents import Choose, Intent, Jog, Stop, Theme
from gui.window.run import Bridge, errors_shown
from gui.window.theme import style_of
from gui.window.widgets.head import HeadPad
from gui.window.widgets.head3d import Head3d
from gui.window.window import Window

Taken = Callable[[], list[Intent]]
LEFT = Qt.MouseButton.LeftButton


def test_a_theme_applies_to_all_widgets(window: Window) -> None:
    for theme in (Theme.LIGHT, Theme.PROJECTOR, Theme.DARK):
        window.handle(Choose("theme", theme))
        colours = style_of(theme)
        centre = window.grab().toImage().pixelColor(2, 100)
        assert centre.name() == colours.ground
        stop = window.panels.stop_bar
        assert window.grab().toImage().pixelColor(stop.width() // 2, stop.y() + 8).name() == colours.stop


def test_the_language_changes_while_the_window_runs(window: Window, intents: Taken) -> None:
    old = window.panels
    old.header.choices["de"].trigger()
    assert intents() == [Choose("language", "de")]
    assert window.panels is not old
    assert window.panels.sending.send.text() == "Senden"
    assert window.panels.arms.increment.box.text() == "5,0 °"
    QTest.mouseClick(window.panels.arms.rows["short"].plus, LEFT)
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert intents() == [Jog("short", 1), Stop()]


@pytest.mark.qt_no_exception_capture
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_an_error_of_any_thread_is_shown_and_the_window_continues(
    qtbot: QtBot, window: Window, intents: Taken, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise ValueError(f"a bug in {threading.current_thread().name}")

    hooks, bridge, trouble = (sys.excepthook, threading.excepthook), Bridge(), window.panels.trouble
    thread = threading.Thread(target=fail, name="another")
    with errors_shown(lambda text: bridge.post(lambda: window.show_error(text))):
        QTimer.singleShot(0, fail)
        for name in ("MainThread", "another"):
            if name == "another":
                thread.start()
            qtbot.waitUntil(trouble.isVisible)
            assert f"a bug in {name}" in trouble.text.text()
            assert f"a bug in {name}" in caplog.text
            QTest.keyClick(window, Qt.Key.Key_Space)
            assert intents() == [Stop()]
            QTest.mouseClick(trouble.close_button, LEFT)
            assert not trouble.isVisible()
    thread.join()
    bridge.close()
    assert (sys.excepthook, threading.excepthook) == hooks


def test_nothing_is_drawn_while_nothing_changes(window: Window, monkeypatch: pytest.MonkeyPatch) -> None:
    """An unchanged window leaves the processor time to the simulation."""
    painted: list[object] = []
    for kind in (HeadPad, Head3d):
        monkeypatch.setattr(kind, "paintEvent", lambda self, _: painted.append(self))
    for expected in (2, 0):
        painted.clear()
        for _ in range(5):
            window.refresh()
            QApplication.processEvents()
        assert len(painted) <= expected
    window.panels.head.pad.update()
    QApplication.processEvents()
    assert painted == [window.panels.head.pad]


def test_another_robot_is_chosen_by_keyboard(qtbot: QtBot, window: Window, intents: Taken) -> None:
    robots = window.panels.header.robots
    robots.setFocus()
    qtbot.waitUntil(robots.hasFocus)
    QTest.keyClick(robots, Qt.Key.Key_Down)
    assert intents() == [ChooseRobot("bea2")]
