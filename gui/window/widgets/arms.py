"""The arms: a row for each and one for all, increment and speed of + and -."""

from __future__ import annotations

from PyQt5.QtCore import QEvent, QTimer
from PyQt5.QtGui import QHideEvent, QMouseEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QVBoxLayout

from beatrix_zenoh import colours
from beatrix_zenoh.contract.names import ARMS
from gui.console.state.arms import HoldArm, ReleaseArm
from gui.console.state.intents import ALL_ARMS, Choose
from gui.console.state.saved import Choices
from gui.console.state.views import ArmRowView, ArmsView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    RIGHT,
    IntentButton,
    Panel,
    Radio,
    SliderBox,
    filled,
    label,
    set_text,
    spaced,
)

LEAST_INCREMENT = 0.1
"""deg"""
LEAST_SPEED = 1.0
"""deg/s"""
HOLD_MS = 300
"""Time after which a press is a hold."""
BEAT_MS = 100
"""Period of the heartbeats of a hold: if the window hangs, the robots stop."""


class HoldButton(IntentButton):
    """+ or - of an arm: a press reports the intent of its view, a hold reports HoldArm until its end."""

    def __init__(self, arm: str, sign: int) -> None:
        super().__init__()
        self._arm, self._sign = arm, sign
        self._holding = self._held = False
        self._beat = QTimer(self)
        self._beat.timeout.connect(self._hold)
        self.pressed.connect(self._begin)
        self.released.connect(self.end)

    def end(self) -> None:
        """End the hold, if there is one."""
        self._beat.stop()
        if self._holding:
            self._holding = False
            self.intent.emit(ReleaseArm())

    def _begin(self) -> None:
        if not self._held:  # the mouse has not left a held button and come back
            self._beat.start(HOLD_MS)

    def _hold(self) -> None:
        self._beat.setInterval(BEAT_MS)
        self._holding = self._held = True
        self.intent.emit(HoldArm(self._arm, self._sign))

    def _press(self) -> None:
        if not self._held:
            super()._press()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        self._held = False
        super().mousePressEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        super().mouseReleaseEvent(event)
        self._held = False

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        self.end()
        super().hideEvent(event)

    def event(self, event: QEvent) -> bool:
        if event.type() in {QEvent.Type.WindowDeactivate, QEvent.Type.UngrabMouse, QEvent.Type.FocusOut}:
            self.end()
        return super().event(event)


class ArmRow:
    """The controls of one arm, put into a grid."""

    def __init__(self, grid: QGridLayout, row: int, arm: str) -> None:
        self._view: ArmRowView | None = None
        self.title = label()
        if arm in colours.ARMS:
            colour = colours.hexadecimal(colours.ARMS[arm])
            self.title.setStyleSheet(f"border-left: 4px solid {colour}; padding-left: 4px")
        self.minus, self.plus = HoldButton(arm, -1), HoldButton(arm, +1)
        self.sim, self.hw = label(role="sim"), label(role="hw")
        for column, widget in enumerate((self.title, self.minus, self.plus, self.sim, self.hw)):
            grid.addWidget(widget, row, column)
        for button in (self.minus, self.plus):
            button.setProperty("jog", True)  # noqa: FBT003
            button.setMinimumWidth(34)
        for value in (self.sim, self.hw):
            value.setAlignment(RIGHT)

    def show_view(self, view: ArmRowView) -> None:
        """Show the angles."""
        if view == self._view:
            return
        self._view = view
        set_text(self.title, f"{view.axis.upper()}  {view.title}".strip())
        set_text(self.sim, view.sim)
        set_text(self.hw, view.hw)
        for button, shown in ((self.minus, view.minus), (self.plus, view.plus)):
            button.show_view(shown)
            button.setAccessibleName(f"{view.title} {shown.text}")


class ArmsPanel(Panel):
    """The rows of the arms, the mode of + and -, increment and speed."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._view: tuple[ArmsView, Choices] | None = None
        self.setAccessibleName(texts("label.arms"))
        self.relative = Radio(texts, "relative", Choose("relative", value=True))
        self.absolute = Radio(texts, "absolute", Choose("relative", value=False))
        grid = QGridLayout()
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(2)
        grid.addLayout(filled(QHBoxLayout(), self.relative, self.absolute, None), 0, 0, 1, 3)
        for column, side in ((3, "sim"), (4, "hw")):
            grid.addWidget(label(texts(f"label.{side}"), side), 0, column, RIGHT)
            grid.setColumnStretch(column, 1)
        self.rows = {arm: ArmRow(grid, row, arm) for row, arm in enumerate((*ARMS, ALL_ARMS), start=1)}
        for row in self.rows.values():
            row.minus.intent.connect(self.intent)
            row.plus.intent.connect(self.intent)
        self.increment = SliderBox(texts, "increment", least=LEAST_INCREMENT)
        self.speed = SliderBox(texts, "speed", least=LEAST_SPEED)
        for part in (self.relative, self.absolute, self.increment, self.speed):
            part.intent.connect(self.intent)
        self._sliders = spaced(QBoxLayout(QBoxLayout.Direction.TopToBottom), 2)
        filled(self._sliders, self.increment, self.speed)
        filled(spaced(QVBoxLayout(self), 2, (8, 4, 8, 4)), grid, self._sliders)

    def show_compact(self, *, compact: bool) -> None:
        """In a low window, show increment and speed in one row, without sliders."""
        directions = QBoxLayout.Direction
        self._sliders.setSpacing(12 if compact else 2)
        self._sliders.setDirection(directions.LeftToRight if compact else directions.TopToBottom)
        for part in (self.increment, self.speed):
            part.show_compact(compact=compact)

    def show_view(self, whole: View) -> None:
        """Show rows, mode, increment and speed."""
        view, choices = whole.arms, whole.choices
        if (view, choices) == self._view:
            return
        self._view = view, choices
        for row in view.rows:
            self.rows[row.arm].show_view(row)
        self.relative.setChecked(choices.relative)
        self.absolute.setChecked(not choices.relative)
        self.increment.show_value(choices.increment, view.increment_max)
        self.speed.show_value(choices.speed, view.speed_max)
