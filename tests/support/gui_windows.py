"""A real window on a real link, used with mouse and keys."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from PyQt5.QtCore import QEvent, QPoint, QPointF, Qt
from PyQt5.QtGui import QMouseEvent
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QScrollArea,
    QTabWidget,
    QWidget,
    qApp,
)
from recording_link import RecordingLink, ShownState, WatchedState

from beatrix_zenoh import Robot
from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.settings import Settings
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.window.run import linked_window
from gui.window.widgets.files import FilePanel
from gui.window.widgets.head3d import VIEWS
from gui.window.widgets.header import RobotMenu
from gui.window.window import PERIOD_MS, Window

PATIENCE_S = 40.0
PAUSE_MS = 5
SIZE = (1366, 768)
NEAR_DEG = 0.2
HOME = (0.0, 0.0, 0.0)


def begin_again(window: Window, link: RecordingLink, state: WatchedState | ShownState) -> None:
    """Give a closed window this link and state, and show it as a new one."""
    window._link, window._state = link, state
    panels, class_page = window.panels, window.panels.class_page
    for tabs in (panels.tabs, panels.side, panels.low_area, class_page.tabs):
        tabs.setCurrentIndex(0)
    class_page.limit.clear()
    class_page.list.setCurrentItem(class_page.list.topLevelItem(0))
    panels.sequence._view = None
    panels._shown.clear()
    for sheet in (panels.key_sheet, panels.connect_sheet, panels.banner, panels.guide):
        sheet.hide()
    panels.head3d.look_from(VIEWS["front"])
    window.refresh()
    qApp.installEventFilter(window.keys)
    window._timer.start(PERIOD_MS)
    window.showNormal()
    window.resize(*SIZE)
    QApplication.setActiveWindow(window)
    panels.head.pad.setFocus()
    state.intents.clear()
    link.done.clear()


def close_dialogs(window: Window) -> None:
    """Close the dialogs and popups of a window."""
    for panel in window.findChildren(FilePanel):
        if panel.dialog is not None:
            panel.dialog.close()
            panel.dialog.deleteLater()
            panel.dialog = None
    while (popup := QApplication.activePopupWidget()) is not None:
        popup.close()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)


class Windowed:
    """A user of a window: presses controls and reads what they show."""

    def __init__(self, window: Window, state: State) -> None:
        self.window, self.state = window, state

    @property
    def last(self) -> str:
        """The last command with its outcome, as shown beside STOP."""
        return self.window.panels.stop_bar.last.text()

    def press(self, button: QWidget) -> None:
        """Show the tab of a button, and click the button with the mouse."""
        reveal(button)
        assert button.isVisible(), f"{button.accessibleName()} is hidden"
        assert whole(button), f"{button.accessibleName()} is cut"
        assert button.isEnabled(), f"{button.accessibleName()} is off: {button.toolTip()}"
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        self.until_shown()

    def check(self, box: QAbstractButton, *, on: bool = True) -> None:
        """Click a box unless it has this state already."""
        reveal(box)
        if box.isChecked() != on:
            QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=QPoint(8, box.height() // 2))
        assert box.isChecked() is on

    def send_to(self, *sides: str) -> None:
        """Check these robots only."""
        sending = self.window.panels.sending
        self.check(sending.sim, on="sim" in sides)
        self.check(sending.hw, on="hw" in sides)

    def until_shown(self) -> None:
        """Wait until the window shows the newest request, so that tests do not read older results."""
        self.until(lambda: not self.window.refresh_pending, "the request is shown")

    def type_number(self, box: QAbstractSpinBox, number: float) -> None:
        """Type a number into a box, and press Enter."""
        box.setFocus()
        self.until(box.hasFocus, "the box has the focus")
        box.selectAll()
        QTest.keyClicks(box, f"{number:g}")
        QTest.keyClick(box, Qt.Key.Key_Return)

    def until(self, holds: Callable[[], bool], what: str, timeout_s: float = PATIENCE_S) -> None:
        """Process events of the window until a condition holds."""
        deadline_s = time.monotonic() + timeout_s
        while not holds():
            assert time.monotonic() < deadline_s, f"not within {timeout_s} s: {what}; last: {self.last}"
            QTest.qWait(PAUSE_MS)

    def until_last(self, *words: str, timeout_s: float = PATIENCE_S) -> None:
        """Wait until the last line has all these words."""
        self.until(lambda: all(word in self.last for word in words), f"{words} in the last line", timeout_s)

    def until_at(self, robot: Robot, *arms: float) -> None:
        """Wait until a robot reports these angles (deg) of short, middle and long arm, and rests."""

        def arrived() -> bool:
            return near(robot.positions().arms, arms) and not robot.status().moving

        self.until(arrived, f"{robot} at {arms}; it is at {robot.positions().arms}")

    def until_ready(self, *sides: str) -> None:
        """Wait until the window shows that these robots are ready."""
        pills = self.window.panels.header.pills
        self.until(lambda: all("ready" in pills[side].state.text() for side in sides), f"{sides} ready")


def drag(widget: QWidget, start: QPoint, goal: QPoint) -> None:
    """Drag with the mouse; QTest cannot, because it moves the mouse without a pressed button."""
    steps = (
        (QEvent.Type.MouseButtonPress, start),
        (QEvent.Type.MouseMove, (start + goal) / 2),
        (QEvent.Type.MouseMove, goal),
        (QEvent.Type.MouseButtonRelease, goal),
    )
    left = Qt.MouseButton.LeftButton
    for kind, place in steps:
        held = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseButtonRelease else left
        button = Qt.MouseButton.NoButton if kind == QEvent.Type.MouseMove else left
        event = QMouseEvent(
            kind, QPointF(place), button, Qt.MouseButtons(held), Qt.KeyboardModifier.NoModifier
        )
        QApplication.sendEvent(widget, event)


def whole(widget: QWidget) -> bool:
    """Return whether no part of a widget is outside its window or covered by the edge of its parents."""
    shown = widget.visibleRegion().boundingRect()
    return not shown.isEmpty() and shown == widget.rect()


def reveal(widget: QWidget) -> None:
    """Select the tabs that contain a widget, scroll to it, or open the menu of a pill."""
    menu = widget.window()
    if isinstance(menu, RobotMenu) and menu.isHidden():
        menu.open(menu.parentWidget())
    for tabs in widget.window().findChildren(QTabWidget):
        for number in range(tabs.count()):
            page = tabs.widget(number)
            if page.isAncestorOf(widget):
                tabs.setCurrentIndex(number)
    for area in widget.window().findChildren(QScrollArea):
        if area.isAncestorOf(widget):
            area.ensureWidgetVisible(widget)


def menu_button(window: Window, side: str, text: str) -> QAbstractButton:
    """Return the button of the menu of a pill that shows this text."""
    return next(button for button in window.panels.header.pills[side].menu.buttons if button.text() == text)


def near(arms: ArmAngles, goal: tuple[float, ...], by: float = NEAR_DEG) -> bool:
    """Return whether all angles are within a tolerance (deg)."""
    return all(abs(angle - wanted) < by for angle, wanted in zip(arms, goal, strict=True))


@contextmanager
def windowed(
    endpoint: str, robot: str = "bea", who: str = "ana", saved: Saved | None = None
) -> Iterator[Windowed]:
    """Open a window, shown and active; assert that closing it takes less than 3 s."""
    state = State(saved or Saved())
    with linked_window(Settings(robot, endpoint, who), state, name_given=True) as window:
        window.resize(*SIZE)
        window.show()
        window.activateWindow()
        made = Windowed(window, state)
        made.until(window.isActiveWindow, "the window is active")
        try:
            yield made
        finally:
            window.close()
            window.deleteLater()
            closing_s = time.monotonic()
    assert time.monotonic() - closing_s < 3.0, "closing the window took too long"
