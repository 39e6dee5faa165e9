"""The head: the pad, and the angles of both robots."""

from __future__ import annotations

from PyQt5.QtCore import Qt
from PyQt5.QtGui import QResizeEvent
from PyQt5.QtWidgets import QBoxLayout, QGridLayout, QLabel, QVBoxLayout

from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.views import HeadView
from gui.console.texts import Texts
from gui.window.widgets.controls import Panel, label, set_text, spaced
from gui.window.widgets.head_pad import HeadPad

AXES = ("yaw", "pitch", "roll")
COLUMNS = {"target": "title", "sim": "sim", "hw": "hw"}
"""Columns of the numbers, with their roles."""
ROBOTS = {"sim": "sim", "hw": "hw"}
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
        self._names = {name: texts(f"label.{name}") for name in COLUMNS}
        self._heads: dict[str, QLabel] = {}
        self._titles: list[QLabel] = []
        self._legend = [label(f"{SYMBOLS[name]} {self._names[name]}", role) for name, role in ROBOTS.items()]
        """the symbols of the robots, where the columns are too narrow for words"""
        self.pad.intent.connect(self.intent)
        self._numbers = spaced(QVBoxLayout(), 4)
        self._numbers.addStretch(1)
        for line in self._legend:
            line.setAlignment(Qt.AlignmentFlag.AlignRight)
            line.setMinimumHeight(1)  # so that it does not keep the panel from becoming lower, which hides it
            self._numbers.addWidget(line)
        self._table, self._narrow = QGridLayout(), 0
        """the numbers, and the width (px) that they need without words over the columns of the robots"""
        self._fill(texts)
        self._numbers.addLayout(self._table)
        self._layout = spaced(QBoxLayout(QBoxLayout.Direction.TopToBottom, self), 4, (6, 6, 6, 6))
        self._layout.addWidget(self.pad, 1)
        self._layout.addLayout(self._numbers)

    def _fill(self, texts: Texts) -> None:
        grid = self._table
        grid.setHorizontalSpacing(4)
        grid.setVerticalSpacing(1)
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for column, (name, role) in enumerate(COLUMNS.items(), start=1):
            caption = self._heads[name] = label(f"{SYMBOLS[name]} {self._names[name]}", role)
            caption.setAlignment(right)
            grid.addWidget(caption, 0, column)
            grid.setColumnStretch(column, 1)
        for row, axis in enumerate(AXES, start=1):
            title = label(texts(f"label.{axis}"), "dim")
            self._titles.append(title)
            title.setToolTip(texts(f"tip.{axis}"))
            grid.addWidget(title, row, 0)
            for column, (name, role) in enumerate(COLUMNS.items(), start=1):
                number = label(role=role)
                number.setAlignment(right)
                grid.addWidget(number, row, column)
                self.numbers[name, axis] = number

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Put the numbers beside the pad or below it, where they leave the pad more room."""
        super().resizeEvent(event)
        width, height, table = self.width(), self.height(), self._table.sizeHint()
        beside = min(width - self._narrow, height) > min(width, height - table.height())
        directions = QBoxLayout.Direction
        self._layout.setDirection(directions.LeftToRight if beside else directions.TopToBottom)
        for name in ROBOTS:
            words = "" if beside else f" {self._names[name]}"
            set_text(self._heads[name], SYMBOLS[name] + words)
        needed = sum(line.sizeHint().height() + self._numbers.spacing() for line in self._legend)
        room = height - table.height() - 2 * self._layout.contentsMargins().top()
        for line in self._legend:
            line.setVisible(beside and needed <= room)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme."""
        self.pad.show_theme(theme)
        for number in self.numbers.values():  # constant widths while the head moves
            number.ensurePolished()
            number.setMinimumWidth(number.fontMetrics().horizontalAdvance(WIDEST) + 2)
        parts = [max(title.sizeHint().width() for title in self._titles)]
        number = self.numbers["sim", AXES[0]]
        parts += [self._heads["target"].sizeHint().width(), number.minimumWidth(), number.minimumWidth()]
        self._narrow = sum(parts) + self._table.horizontalSpacing() * (len(parts) - 1)

    def show_view(self, view: HeadView) -> None:
        """Show the pad and the numbers."""
        self.pad.show_view(view)
        self._show_numbers("target", view.target)
        self._show_numbers("sim", view.sim)
        self._show_numbers("hw", view.hw)

    def _show_numbers(self, name: str, at: HeadOrientation | None) -> None:
        for axis in AXES:
            if at is None:
                text = self._texts("unknown")
            else:
                text = self._texts("angle", degrees=float(getattr(at, axis)))
            set_text(self.numbers[name, axis], text)
