"""The buttons above the plots: times, pause, choice of curves and values, export."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable
from typing import Final

from PyQt5.QtCore import QPoint
from PyQt5.QtWidgets import QAction, QHBoxLayout, QMenu, QPushButton, QWidget

from beatrix_zenoh.contract.names import ARMS, SIDES
from beatrix_zenoh.contract.values import Value
from gui.console.texts import Texts
from gui.window.widgets.controls import label, plain_button, spaced

SPANS: Final = (5, 20, 60)
"""Times that the plots show at the press of a button (s)."""
BOTH: Final = ("hw", "sim")
"""The robots in the order in which they are drawn."""
DIFFERENCE: Final = "difference"


def described(text: str, tooltip: str) -> QPushButton:
    """Return a button whose text is too short to be its name."""
    return plain_button(text, tooltip, tooltip)


class PlotBar(QWidget):
    """The buttons above the plots."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._word = texts.word
        row = spaced(QHBoxLayout(self), 4, (4, 4, 4, 0))
        self.spans = {
            seconds: described(f"{seconds} s", texts("tip.plot_span", seconds=str(seconds)))
            for seconds in SPANS
        }
        self.pause = described(texts("plot.pause"), texts("tip.plot_pause"))
        for button in (*self.spans.values(), self.pause):
            button.setCheckable(True)
        self.curves = described(f"{texts('plot.curves')} ▾", texts("tip.plot_curves"))
        self.time = label(role="dim")
        """time at the cursor"""
        self.csv = described("CSV", texts("tip.plot_csv"))
        self.png = described("PNG", texts("tip.plot_png"))
        for button in (*self.spans.values(), self.pause, self.curves):
            row.addWidget(button)
        row.addWidget(self.time, 1)
        row.addWidget(self.csv)
        row.addWidget(self.png)
        self.menu = QMenu(self)
        self.choices = {
            name: self._choice(texts(f"label.{name}" if name in (*SIDES, DIFFERENCE) else f"arm.{name}"))
            for name in (*BOTH, *ARMS, DIFFERENCE)
        }
        """by side, arm or DIFFERENCE"""
        self.menu.addSeparator()
        self.values = self.menu.addMenu(texts("plot.values"))
        """the values of the robots, in groups; `offer` fills it"""
        self.curves.clicked.connect(self._open_menu)

    def _choice(self, text: str) -> QAction:
        action = QAction(text, self.menu)
        action.setCheckable(True)
        action.setChecked(True)
        self.menu.addAction(action)
        return action

    def _open_menu(self) -> None:
        """Open the menu without blocking the window."""
        self.menu.popup(self.curves.mapToGlobal(QPoint(0, self.curves.height())))

    def chosen(self, name: str) -> bool:
        """Return whether a side, an arm or the difference is shown."""
        return self.choices[name].isChecked()

    def offer(
        self, found: Iterable[Value], watched: Container[str], watch: Callable[[Value, bool], None]
    ) -> None:
        """Offer these values in the menu; those whose field is in `watched` are checked."""
        self.values.clear()
        groups: dict[str, QMenu] = {}
        for value in found:
            if value.group not in groups:
                groups[value.group] = self.values.addMenu(self._word(value.group))
            action = groups[value.group].addAction(self._word(value.title))
            action.setCheckable(True)
            action.setChecked(value.field in watched)
            action.toggled.connect(lambda on, value=value: watch(value, on))
