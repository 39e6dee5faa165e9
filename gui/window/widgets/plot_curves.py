"""The parts of the plots: one plot with its curves and cursor, and the buttons above all plots."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Sequence
from typing import Final, NamedTuple

import numpy as np
import pyqtgraph as pg
from PyQt5.QtCore import QPoint, Qt, pyqtSignal
from PyQt5.QtGui import QFont, QPen
from PyQt5.QtWidgets import QAction, QHBoxLayout, QLabel, QMenu, QPushButton, QVBoxLayout, QWidget
from pyqtgraph.GraphicsScene.mouseEvents import HoverEvent

from beatrix_zenoh.contract.names import ARMS, SIDES
from beatrix_zenoh.contract.values import Value
from gui.console.texts import Texts
from gui.window.theme import Style
from gui.window.widgets.controls import NO_MARGINS, filled, label, plain_button, spaced
from gui.window.widgets.plot_samples import SPAN_MAX_S, Samples

SPAN_MIN_S: Final = 1.0
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
        filled(row, *self.spans.values(), self.pause, self.curves, (self.time, 1), self.csv, self.png)
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


class Name(NamedTuple):
    """Name of a curve in the legend, and the sign that looks like its line."""

    sign: str
    text: str


class TimeBox(pg.ViewBox):  # type: ignore[misc]  # pyqtgraph has no types
    """The area of the curves. The wheel zooms at the mouse, and dragging shows other times."""

    pointed = pyqtSignal(object)
    """time at the mouse (s, before now); None: it has left"""

    def __init__(self) -> None:
        super().__init__(enableMenu=False)
        self.setMouseEnabled(x=True, y=False)
        self.setLimits(xMin=-SPAN_MAX_S, xMax=0.0, minXRange=SPAN_MIN_S, maxXRange=SPAN_MAX_S)
        self.setAutoVisible(y=True)

    def hoverEvent(self, event: HoverEvent) -> None:  # noqa: N802
        """Report the time at the mouse."""
        self.pointed.emit(None if event.isExit() else self.mapToView(event.pos()).x())


class Curves(QWidget):
    """One plot: curves over time, under a title and a legend."""

    moved = pyqtSignal(float, float)
    """the plot shows other times (s, before now)"""

    def __init__(self, texts: Texts, title: str, least: float, names: Sequence[Name]) -> None:
        """Create a plot without samples.

        Args:
            texts: the language, also of the numbers.
            title: quantity and unit.
            least: smallest range of the vertical axis.
            names: name of each curve; a curve without a name is not in the legend. The last curve is on top.
        """
        super().__init__()
        self._texts, self._title, self._names = texts, title, names
        self._legend: list[str] = []
        self._chosen = [True for _ in names]
        self._shown: list[tuple[Samples, Samples]] = []
        self.label = QLabel()
        self.label.setWordWrap(True)
        self.box = TimeBox()
        self.box.setLimits(minYRange=least)
        self.area = pg.PlotWidget(viewBox=self.box)
        self.area.setMinimumSize(1, 1)
        self.plot = self.area.getPlotItem()
        self.plot.hideButtons()
        self.plot.showGrid(x=True, y=True, alpha=0.2)
        filled(spaced(QVBoxLayout(self), 0, NO_MARGINS), self.label, (self.area, 1))
        self.lines = [self.plot.plot(connect="finite", antialias=True, clipToView=True) for _ in names]
        self._cursor = pg.InfiniteLine(angle=90)
        self._cursor.hide()
        self.plot.addItem(self._cursor, ignoreBounds=True)
        self.box.sigXRangeChanged.connect(lambda _, times: self.moved.emit(*times))
        for side, unit in (("left", ""), ("bottom", " s")):
            axis = self.plot.getAxis(side)
            axis.enableAutoSIPrefix(enable=False)
            axis.tickStrings = self._ticks(unit)

    def _ticks(self, unit: str) -> Callable[[Sequence[float], float, float], list[str]]:
        """Return a function of pyqtgraph that labels an axis in the language of the window."""

        def strings(values: Sequence[float], _scale: float, _spacing: float) -> list[str]:
            return [self._number(value, "figure") + unit for value in values]

        return strings

    def _number(self, value: float, key: str) -> str:
        return self._texts(key, value=round(value, 6) + 0.0)

    def show_times(self, begin_s: float, end_s: float) -> None:
        """Show these times (s, before now)."""
        self.box.setXRange(begin_s, end_s, padding=0.0)

    def choose(self, chosen: Sequence[bool]) -> None:
        """Show only the chosen curves, in the plot and in the legend."""
        self._chosen = list(chosen)
        for line, shown in zip(self.lines, chosen, strict=True):
            line.setVisible(shown)
        self._show_legend()

    def rename(self, title: str) -> None:
        """Show another quantity and unit."""
        self._title = title
        self._show_legend()

    def draw(self, curves: Sequence[tuple[Samples, Samples]]) -> None:
        """Draw times (s, before now) and values of each curve."""
        self._shown = list(curves)
        for line, (times, values) in zip(self.lines, curves, strict=True):
            line.setData(times, values)

    def read(self, time_s: float | None) -> None:
        """Put the cursor at a time (s, before now), and the values there into the legend; None: no cursor."""
        self._cursor.setVisible(time_s is not None)
        values: list[str] = []
        if time_s is not None:
            self._cursor.setPos(time_s)
            values = [self._value(times, angles, time_s) for times, angles in self._shown]
        self._show_legend(values)

    def _value(self, times: Samples, angles: Samples, time_s: float) -> str:
        value = np.interp(time_s, times, angles, left=math.nan, right=math.nan) if len(times) else math.nan
        return self._number(float(value), "plot.value") if math.isfinite(value) else self._texts("unknown")

    def _show_legend(self, values: Sequence[str] = ()) -> None:
        """Show the title, the names of the curves, and their values, if there are any."""
        entries = [f"<b>{self._title}</b>"]
        for number, (line, name) in enumerate(zip(self._legend, self._names, strict=False)):
            words = [name.text] if name.text else []
            if values:
                words.append(f"<b>{values[number]}</b>")
            if words and self._chosen[number]:
                entries.append(f"{line}&nbsp;" + " ".join(words).replace(" ", "&nbsp;"))
        text = " &nbsp; ".join(entries)
        if text != self.label.text():
            self.label.setText(text)

    def show_theme(self, pens: Sequence[QPen], colours: Style) -> None:
        """Use these pens and the colours of a theme."""
        for line, pen in zip(self.lines, pens, strict=True):
            line.setPen(pen)
        self._cursor.setPen(pg.mkPen(colours.edge, width=1, style=Qt.PenStyle.DashLine))
        self._legend = [
            f"<span style='color:{pen.color().name()}'>{name.sign.replace(' ', '&nbsp;')}</span>"
            for pen, name in zip(pens, self._names, strict=True)
        ]
        self._show_legend()
        self.label.setStyleSheet(f"color: {colours.text}; font-size: {colours.px(12)}px")
        self.area.setBackground(colours.field)
        font = QFont()
        font.setPixelSize(colours.px(11))
        for side in ("left", "bottom"):
            axis = self.plot.getAxis(side)
            axis.setPen(colours.edge)
            axis.setTextPen(colours.text)
            axis.setTickFont(font)
        self.plot.getAxis("left").setWidth(colours.px(34))

    def show_time_axis(self, *, shown: bool) -> None:
        """Show or hide the labels of the time."""
        self.plot.getAxis("bottom").setStyle(showValues=shown)
