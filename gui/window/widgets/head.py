"""The head: the pad, and the angles of both robots."""

from __future__ import annotations

from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QLabel, QVBoxLayout

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.widgets.controls import RIGHT, Panel, label, set_text, spaced
from gui.window.widgets.head_pad import HeadPad

AXES = ("yaw", "pitch", "roll")
COLUMNS = {"target": "title", "sim": "sim", "hw": "hw"}
"""Columns of the numbers, with their roles."""
WIDEST = "−88.8°"
SYMBOLS = {"target": "○", "sim": "+", "hw": "■"}
"""The markers of the pad."""


class HeadPanel(Panel):
    """The present and the target orientation of the head."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("panel")
        self._texts = texts
        self.pad = HeadPad(texts)
        self.pad.setProperty("sends", True)  # noqa: FBT003
        self.numbers: dict[tuple[str, str], QLabel] = {}
        self._names: dict[str, QLabel] = {}
        self.pad.intent.connect(self.intent)
        self._table = self._filled(texts)
        beside = QVBoxLayout()
        beside.addStretch(1)
        beside.addLayout(self._table)
        self._layout = spaced(QBoxLayout(QBoxLayout.Direction.TopToBottom, self), 4, (6, 6, 6, 6))
        self._layout.addWidget(self.pad, 1)
        self._layout.addLayout(beside)

    def _filled(self, texts: Texts) -> QGridLayout:
        grid = spaced(QGridLayout(), 1)
        grid.setHorizontalSpacing(4)
        for column, (name, role) in enumerate(COLUMNS.items(), start=1):
            self._names[name] = label(role=role)
            self._names[name].setAlignment(RIGHT)
            grid.addWidget(self._names[name], 0, column)
            grid.setColumnStretch(column, 1)
        for row, axis in enumerate(AXES, start=1):
            title = label(texts(f"label.{axis}"), "dim")
            title.setToolTip(texts(f"tip.{axis}"))
            grid.addWidget(title, row, 0)
            for column, (name, role) in enumerate(COLUMNS.items(), start=1):
                number = self.numbers[name, axis] = label(role=role)
                number.setAlignment(RIGHT)
                grid.addWidget(number, row, column)
        return grid

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the numbers below the pad or, in a wide panel, beside it, where only their symbols have room."""
        super().resizeEvent(event)
        beside = self.width() > 1.3 * self.height()
        directions = QBoxLayout.Direction
        self._layout.setDirection(directions.LeftToRight if beside else directions.TopToBottom)
        for name, heading in self._names.items():
            words = self._texts(f"label.{name}")
            set_text(heading, SYMBOLS[name] if beside else f"{SYMBOLS[name]} {words}")
            heading.setToolTip(words)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.pad.show_theme(theme)
        for number in self.numbers.values():  # constant widths while the head moves
            number.ensurePolished()
            number.setMinimumWidth(number.fontMetrics().horizontalAdvance(WIDEST) + 2)

    def show_view(self, view: HeadView) -> None:
        """Show the pad and the numbers."""
        self.pad.show_view(view)
        for (name, axis), number in self.numbers.items():
            at: HeadOrientation | None = getattr(view, name)
            unknown = at is None
            text = self._texts("unknown") if unknown else self._texts("angle", degrees=getattr(at, axis))
            set_text(number, text)
