"""Keys of the whole window, and the sheet that lists them. Those of STOP work regardless of the focus, and while a popup is open."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from PyQt5.QtCore import QEvent, QObject, Qt, QTimer
from PyQt5.QtGui import QKeyEvent, QMouseEvent
from PyQt5.QtWidgets import (
    QAbstractButton,
    QApplication,
    QDialog,
    QGridLayout,
    QLineEdit,
    QPlainTextEdit,
    QWidget,
    qApp,
)

from gui.console.state.arms import ReleaseArm, Steer
from gui.console.state.intents import Intent
from gui.console.texts import Texts
from gui.window.widgets.arms import BEAT_MS
from gui.window.widgets.controls import Sheet, label, plain_button, spaced

STOP_KEYS = {Qt.Key.Key_Space, Qt.Key.Key_Escape, Qt.Key.Key_Pause}
SEND_KEYS = {Qt.Key.Key_Return, Qt.Key.Key_Enter}
PAGES = {Qt.Key.Key_F1: "help", Qt.Key.Key_F2: "page", Qt.Key.Key_F11: "projector"}
SHEET = (
    "stop",
    "code",
    "send",
    "pad",
    "yaw",
    "steer",
    "press",
    "undo",
    "record",
    "class",
    "projector",
    "tab",
    "help",
)
STEERS: Final = {
    Qt.Key.Key_A: (1.0, 0.0, 0.0),
    Qt.Key.Key_D: (-1.0, 0.0, 0.0),
    Qt.Key.Key_W: (0.0, -1.0, 0.0),
    Qt.Key.Key_S: (0.0, 1.0, 0.0),
    Qt.Key.Key_Q: (0.0, 0.0, -1.0),
    Qt.Key.Key_E: (0.0, 0.0, 1.0),
}
"""Keys that turn the head while they are held: shares of yaw, pitch and roll, for a head seen from behind."""
OTHERS: Final = (
    Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier
)
ENDS: Final = (QEvent.Type.FocusOut, QEvent.Type.Hide, QEvent.Type.WindowDeactivate)


class Keys(QObject):
    """Filters the events of the whole application before any widget receives them.

    Qt's shortcuts are not enough: a shortcut takes 0.1 s to click its button, and text fields and popups consume keys.
    """

    def __init__(self, stop_bar: Callable[[], QWidget], acts: Mapping[str, Callable[[], object]]) -> None:
        """Start filtering.

        Args:
            stop_bar: returns the STOP button, which also works while a popup is open.
            acts: what the keys do; `escape` is done after STOP, and closes what lies over the window.
        """
        super().__init__()
        self._stop_bar, self._acts = stop_bar, acts
        qApp.installEventFilter(self)

    def remove(self) -> None:
        """Stop filtering."""
        qApp.removeEventFilter(self)

    def eventFilter(self, _watched: QObject | None, event: QEvent | None) -> bool:  # noqa: N802
        if isinstance(event, QKeyEvent):
            if event.type() == QEvent.Type.ShortcutOverride:
                return self._override(event)
            if event.type() == QEvent.Type.KeyPress:
                return self._press(event)
        elif isinstance(event, QMouseEvent) and event.type() == QEvent.Type.MouseButtonPress:
            return self._press_outside_popup(event)
        return False

    def _override(self, event: QKeyEvent) -> bool:
        """Keep the keys of STOP from becoming shortcuts of a menu or dialog."""
        if event.key() in STOP_KEYS:
            event.accept()
            return True
        return False

    def _press(self, event: QKeyEvent) -> bool:
        act = None if typed(event) else self._action(event)
        if act is None:
            return False
        event.accept()
        if not event.isAutoRepeat():
            act()
        return True

    def _action(self, event: QKeyEvent) -> Callable[[], object] | None:
        key, focus = event.key(), QApplication.focusWidget()
        if key in STOP_KEYS:
            return self._escape if key == Qt.Key.Key_Escape else self._stop
        if key in PAGES:
            return self._acts[PAGES[Qt.Key(key)]]
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            if key == Qt.Key.Key_R:
                return self._acts["record"]
            if key == Qt.Key.Key_Z and not isinstance(focus, QLineEdit):
                return self._acts["undo"]
        if key in SEND_KEYS:
            return self._enter(focus)
        return None

    def _enter(self, focus: QWidget | None) -> Callable[[], object] | None:
        """Return the action of Enter; None if Qt handles the key.

        Enter presses the focused button, because Space, Qt's key for that, is STOP. If the pad or no widget has the
        focus, Enter sends the target.
        """
        popup = QApplication.activePopupWidget()
        if popup is not None or isinstance(QApplication.activeWindow(), QDialog):
            return None
        if isinstance(focus, QAbstractButton):
            return focus.click
        if focus is None or focus.property("sends"):
            return self._acts["send"]
        return None

    def _stop(self) -> None:
        self._acts["stop"]()
        popup = QApplication.activePopupWidget()
        if popup is not None:
            popup.close()

    def _escape(self) -> None:
        self._stop()
        self._acts["escape"]()

    def _press_outside_popup(self, event: QMouseEvent) -> bool:
        """Send STOP for a press on the STOP button while a popup is open; Qt alone would only close the popup."""
        bar = self._stop_bar()
        if QApplication.activePopupWidget() is None or not bar.isVisible():
            return False
        if not bar.rect().contains(bar.mapFromGlobal(event.globalPos())):
            return False
        self._stop()
        return True


def typed(event: QKeyEvent) -> bool:
    """Return whether a key is typed into a program: Space, or Ctrl+Z."""
    focus, undoes = QApplication.focusWidget(), event.modifiers() & Qt.KeyboardModifier.ControlModifier
    if QApplication.activePopupWidget() is not None or not isinstance(focus, QPlainTextEdit):
        return False
    return not focus.isReadOnly() and event.key() == (Qt.Key.Key_Z if undoes else Qt.Key.Key_Space)


class KeySheet(Sheet):
    """All keys of the window."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(texts("label.keys"), parent)
        layout = spaced(QGridLayout(self), None, (20, 14, 20, 14))
        layout.setHorizontalSpacing(24)
        layout.addWidget(label(texts("label.keys"), "large"), 0, 0, 1, 2)
        for row, name in enumerate(SHEET, start=1):
            keys, _, meaning = texts(f"label.keys_{name}").partition(": ")
            layout.addWidget(label(keys, "title"), row, 0)
            layout.addWidget(label(meaning), row, 1)
        self.close_button = plain_button(texts("label.dismiss"), texts("label.keys_help"))
        self.close_button.clicked.connect(self.hide)
        layout.addWidget(self.close_button, len(SHEET) + 1, 1)

    def toggle(self) -> None:
        """Show or hide the sheet."""
        if self.isVisible():
            self.hide()
        else:
            self.appear(self.close_button)


class Steering(QObject):
    """Reports Steer while one of the widgets has the focus and keys are held, as often as a held button."""

    def __init__(self, widgets: tuple[QWidget, ...], report: Callable[[Intent], None]) -> None:
        """Watch the keys of widgets; `report` gets the intents."""
        super().__init__(widgets[0])
        self._report = report
        self._held: set[int] = set()
        self.mirrored = False
        """whether the head is seen from the front: left and right are those of the picture"""
        self._beat = QTimer(self)
        self._beat.setInterval(BEAT_MS)
        self._beat.timeout.connect(self._steer)
        for widget in widgets:
            widget.installEventFilter(self)

    def eventFilter(self, _watched: QObject | None, event: QEvent | None) -> bool:  # noqa: N802
        if event is not None and event.type() in ENDS and self._held:
            self._held.clear()
            self._steer()
        if not isinstance(event, QKeyEvent) or event.key() not in STEERS:
            return False
        if event.type() not in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease) or event.modifiers() & OTHERS:
            return False
        if not event.isAutoRepeat():
            (self._held.add if event.type() == QEvent.Type.KeyPress else self._held.discard)(event.key())
            self._steer()
        return True

    def _steer(self) -> None:
        side = -1.0 if self.mirrored else 1.0
        held = [STEERS[Qt.Key(key)] for key in self._held]
        yaw, pitch, roll = (sum(shares[axis] for shares in held) for axis in range(3))
        if yaw or pitch or roll:
            self._report(Steer(side * yaw, pitch, side * roll))
            self._beat.start()
        elif self._beat.isActive():
            self._beat.stop()
            self._report(ReleaseArm())
