"""Keys that turn the head while they are held: W, A, S, D, Q and E."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from PyQt5.QtCore import QEvent, QObject, Qt, QTimer
from PyQt5.QtGui import QKeyEvent
from PyQt5.QtWidgets import QWidget

from gui.console.state.arms import ReleaseArm, Steer
from gui.console.state.intents import Intent
from gui.window.widgets.arms import BEAT_MS

KEYS: Final = {
    Qt.Key.Key_A: (1.0, 0.0, 0.0),
    Qt.Key.Key_D: (-1.0, 0.0, 0.0),
    Qt.Key.Key_W: (0.0, -1.0, 0.0),
    Qt.Key.Key_S: (0.0, 1.0, 0.0),
    Qt.Key.Key_Q: (0.0, 0.0, -1.0),
    Qt.Key.Key_E: (0.0, 0.0, 1.0),
}
"""Shares of yaw, pitch and roll of each key, for a head seen from behind."""
OTHERS: Final = (
    Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier
)
ENDS: Final = (QEvent.Type.FocusOut, QEvent.Type.Hide, QEvent.Type.WindowDeactivate)


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
        if not isinstance(event, QKeyEvent) or event.key() not in KEYS:
            return False
        if event.type() not in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease) or event.modifiers() & OTHERS:
            return False
        if not event.isAutoRepeat():
            (self._held.add if event.type() == QEvent.Type.KeyPress else self._held.discard)(event.key())
            self._steer()
        return True

    def _steer(self) -> None:
        side = -1.0 if self.mirrored else 1.0
        held = [KEYS[Qt.Key(key)] for key in self._held]
        yaw, pitch, roll = (sum(shares[axis] for shares in held) for axis in range(3))
        if yaw or pitch or roll:
            self._report(Steer(side * yaw, pitch, side * roll))
            self._beat.start()
        elif self._beat.isActive():
            self._beat.stop()
            self._report(ReleaseArm())
