"""The head: the pad, and the angles of both robots."""

from __future__ import annotations

from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QLabel

from gui.console.state.intents import Theme
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.widgets.controls import RIGHT, Panel, in_column, label, set_text, spaced
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
        self.numbers = {(name, axis): self._right(role) for name, role in COLUMNS.items() for axis in AXES}
        self._names = {name: self._right(role) for name, role in COLUMNS.items()}
        self.reports(self.pad)
        grid = spaced(QGridLayout(), 1)
        grid.setHorizontalSpacing(4)
        for column_number, name in enumerate(COLUMNS, start=1):
            grid.setColumnStretch(column_number, 1)
            grid.addWidget(self._names[name], 0, column_number)
            for line, axis in enumerate(AXES, start=1):
                grid.addWidget(self.numbers[name, axis], line, column_number)
        for line, axis in enumerate(AXES, start=1):
            title = label(texts(f"label.{axis}"), "dim")
            title.setToolTip(texts(f"tip.{axis}"))
            grid.addWidget(title, line, 0)
        self._layout = in_column(
            (self.pad, 1), in_column(None, grid), gap=4, margins=(6, 6, 6, 6), inside=self
        )

    @staticmethod
    def _right(role: str) -> QLabel:
        made = label(role=role)
        made.setAlignment(RIGHT)
        return made

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
            at = view.target if name == "target" else view.side(name)
            known = at is not None
            set_text(
                number, self._texts("angle", degrees=getattr(at, axis)) if known else self._texts("unknown")
            )
