"""One plot with its curves and cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import pyqtgraph as pg
from PyQt5.QtCore import Qt, pyqtSignal
from PyQt5.QtGui import QFont, QPen
from PyQt5.QtWidgets import QLabel, QWidget
from pyqtgraph.GraphicsScene.mouseEvents import HoverEvent

from gui.console.texts import Texts
from gui.window.theme import Style
from gui.window.widgets.controls import NO_MARGINS, in_column
from gui.window.widgets.plot_samples import SPAN_MAX_S, Samples

SPAN_MIN_S: Final = 1.0


class TimeBox(pg.ViewBox):  # type: ignore[misc]  # pyqtgraph has no types
    """The area of the curves. The wheel zooms at the mouse, and dragging shows other times."""

    pointed = pyqtSignal(object)
    """time at the mouse (s, before now); None: it has left"""

    def __init__(self) -> None:
        super().__init__(enableMenu=False)
        self.setMouseEnabled(x=True, y=False)
        self.setLimits(xMin=-SPAN_MAX_S, xMax=0.0, minXRange=SPAN_MIN_S, maxXRange=SPAN_MAX_S)

    def hoverEvent(self, event: HoverEvent) -> None:  # noqa: N802
        """Report the time at the mouse."""
        self.pointed.emit(None if event.isExit() else self.mapToView(event.pos()).x())


class Curves(QWidget):
    """One plot: curves over time, under a title and a legend."""

    moved = pyqtSignal(float, float)
    """the user wants to see other times (s, before now)"""

    def __init__(
        self, parent: QWidget, texts: Texts, title: str, least: float, names: Sequence[tuple[str, str]]
    ) -> None:
        """Create a plot without samples.

        Args:
            parent: the panel of all plots.
            texts: the language, also of the numbers.
            title: quantity and unit.
            least: smallest range of the vertical axis.
            names: of each curve a sign that looks like its line, and its name, which may be empty. The last is on top.
        """
        super().__init__(parent)
        self._texts, self.title, self._names = texts, title, names
        self.label = QLabel()
        self.label.setWordWrap(True)
        self.box = TimeBox()
        self._least, self._range = least, (0.0, 0.0)
        self.area = pg.PlotWidget(viewBox=self.box)
        self.area.setMinimumSize(1, 1)
        self.plot = self.area.getPlotItem()
        self.plot.hideButtons()
        self.plot.showGrid(x=True, y=True, alpha=0.2)
        in_column(self.label, (self.area, 1), gap=0, margins=NO_MARGINS, inside=self)
        self.lines = [self.plot.plot(connect="finite", antialias=True) for _ in names]
        self._cursor = pg.InfiniteLine(angle=90)
        self._cursor.hide()
        self.plot.addItem(self._cursor, ignoreBounds=True)
        self.box.sigRangeChangedManually.connect(lambda: self.moved.emit(*self.box.viewRange()[0]))
        for side, unit in (("left", ""), ("bottom", " s")):
            axis = self.plot.getAxis(side)
            axis.enableAutoSIPrefix(enable=False)
            axis.tickStrings = lambda values, *_, unit=unit: [
                self._number(value, "figure") + unit for value in values
            ]

    def _number(self, value: float, key: str) -> str:
        return self._texts(key, value=round(value, 6) + 0.0)

    def choose(self, chosen: Sequence[bool]) -> None:
        """Show only the chosen curves, in the plot and in the legend."""
        for line, shown in zip(self.lines, chosen, strict=True):
            line.setVisible(shown)

    def draw(self, curves: Sequence[tuple[Samples, Samples]], cursor_s: float | None) -> None:
        """Draw times (s, before now) and values of each curve; show the values at the cursor, if there is one."""
        for line, (times, values) in zip(self.lines, curves, strict=True):
            line.setData(times, values)
        self._fit([values for line, (_, values) in zip(self.lines, curves, strict=True) if line.isVisible()])
        self._cursor.setVisible(cursor_s is not None)
        if cursor_s is not None:
            self._cursor.setPos(cursor_s)
        self._show_legend([self._value(*curve, cursor_s) for curve in curves])

    def _fit(self, curves: Sequence[Samples]) -> None:
        """Show all values between round numbers: labels of an axis are costly to draw anew."""
        values = np.concatenate([*curves, np.empty(0)])
        values = values[np.isfinite(values)]
        if len(values):
            step = self._least / 4
            low, high = (math.floor(values.min() / step), math.ceil(values.max() / step))
            missing = max(0, 4 - (high - low))
            limits = (low - (missing - missing // 2)) * step, (high + missing // 2) * step
            if limits != self._range:
                self._range = limits
                self.box.setYRange(*limits, padding=0.03)

    def _value(self, times: Samples, values: Samples, time_s: float | None) -> str:
        """Return a value in bold; empty without a time."""
        if time_s is None:
            return ""
        value = np.interp(time_s, times, values, left=math.nan, right=math.nan) if len(times) else math.nan
        known = math.isfinite(value)
        return f"<b>{self._number(float(value), 'plot.value') if known else self._texts('unknown')}</b>"

    def _show_legend(self, values: Sequence[str]) -> None:
        """Show the title, the names of the curves, and their values, if there are any."""
        entries = [f"<b>{self.title}</b>"]
        for line, (sign, name), value in zip(self.lines, self._names, values, strict=True):
            words = " ".join(filter(None, (name, value)))
            if words and line.isVisible():
                mark = f"<span style='color:{line.opts['pen'].color().name()}'>{sign}</span>"
                entries.append(f"{mark}&nbsp;{words.replace(' ', '&nbsp;')}")
        text = " &nbsp; ".join(entries)
        if text != self.label.text():
            self.label.setText(text)

    def show_theme(self, pens: Sequence[QPen], colours: Style) -> None:
        """Use these pens and the colours of a theme."""
        for line, pen in zip(self.lines, pens, strict=True):
            line.setPen(pen)
        self._cursor.setPen(pg.mkPen(colours.edge, width=1, style=Qt.PenStyle.DashLine))
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
