"""The arms: a row for each and one for all, increment and speed of + and -."""

from __future__ import annotations

from PyQt5.QtCore import QEvent, QTimer
from PyQt5.QtGui import QHideEvent, QMouseEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QRadioButton

from beatrix_zenoh import colours
from beatrix_zenoh.contract.names import ARMS
from gui.console.state.arms import HoldArm, ReleaseArm
from gui.console.state.intents import ALL_ARMS, Choose
from gui.console.state.views import ArmRowView, View
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    RIGHT,
    IntentButton,
    Panel,
    SliderBox,
    in_column,
    in_row,
    label,
    named,
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
        self.title = label()
        if arm in colours.ARMS:
            colour = colours.hexadecimal(colours.ARMS[arm])
            self.title.setStyleSheet(f"border-left: 4px solid {colour}; padding-left: 4px")
        self.minus, self.plus = HoldButton(arm, -1), HoldButton(arm, +1)
        self.sim, self.hw = label(role="sim", right=True), label(role="hw", right=True)
        for column, widget in enumerate((self.title, self.minus, self.plus, self.sim, self.hw)):
            grid.addWidget(widget, row, column)
        for button in (self.minus, self.plus):
            button.setProperty("jog", True)  # noqa: FBT003
            button.setMinimumWidth(34)

    def show_view(self, view: ArmRowView) -> None:
        """Show the angles."""
        self.title.setText(f"{view.axis.upper()}  {view.title}".strip())
        self.sim.setText(view.sim)
        self.hw.setText(view.hw)
        for button, shown in ((self.minus, view.minus), (self.plus, view.plus)):
            button.show_view(shown, view.title)


class ArmsPanel(Panel):
    """The rows of the arms, the mode of + and -, increment and speed."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self.setAccessibleName(texts("label.arms"))
        self.relative, self.absolute = (self._mode(texts, name) for name in ("relative", "absolute"))
        grid = QGridLayout()
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(2)
        grid.addLayout(in_row(self.relative, self.absolute, None), 0, 0, 1, 3)
        for place, side in ((3, "sim"), (4, "hw")):
            grid.addWidget(label(texts(f"label.{side}"), side), 0, place, RIGHT)
            grid.setColumnStretch(place, 1)
        self.rows = {arm: ArmRow(grid, line, arm) for line, arm in enumerate((*ARMS, ALL_ARMS), start=1)}
        for shown in self.rows.values():
            self.reports(shown.minus.intent, shown.plus.intent)
        self.increment = SliderBox(texts, "increment", least=LEAST_INCREMENT)
        self.speed = SliderBox(texts, "speed", least=LEAST_SPEED)
        self.reports(self.increment.intent, self.speed.intent)
        self._sliders = in_column(self.increment, self.speed, gap=2)
        in_column(grid, self._sliders, gap=2, margins=(8, 4, 8, 4), inside=self)

    def _mode(self, texts: Texts, name: str) -> QRadioButton:
        text = texts(f"label.{name}")
        button = named(QRadioButton(text), text, texts(f"tip.{name}"))
        button.clicked.connect(lambda: self.intent.emit(Choose("relative", value=name == "relative")))
        return button

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
        for shown in view.rows:
            self.rows[shown.arm].show_view(shown)
        (self.relative if choices.relative else self.absolute).setChecked(True)
        self.increment.show_value(choices.increment, view.increment_max)
        self.speed.show_value(choices.speed, view.speed_max)
