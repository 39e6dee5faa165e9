"""Arm angles of both robots over the last 20 s, and their difference."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt
import pyqtgraph as pg
from PyQt5.QtCore import Qt
from PyQt5.QtGui import QColor, QFont, QPen, QShowEvent
from PyQt5.QtWidgets import QLabel, QStackedLayout, QVBoxLayout, QWidget

from beatrix_zenoh import colours as table
from beatrix_zenoh.client import RobotState
from beatrix_zenoh.contract.names import ARMS
from gui.console.state.intents import Theme
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.theme import Style, style_of

Samples = npt.NDArray[np.float64]

SPAN_S: Final = 20.0
"""Time that the plots show."""
TICKS: Final = (-20, -15, -10, -5, 0)
"""Labels of the time axis (s)."""
PERIOD_S: Final = 0.045
"""Shortest time between two drawings: 20 a second with some slack."""
CAPACITY: Final = 1024
"""Number of samples kept for each robot: 50 a second for 20 s."""
GAP_S: Final = 1.0
"""A line is interrupted after this time without a sample."""
FOREIGN_S: Final = 1.0
"""If the clock offset is unknown and a stamp is this far from its arrival, the arrival is used instead."""
LEAST_ARM_DEG: Final = 20.0
"""Smallest range (deg) of the vertical axis of an arm's plot."""
LEAST_DIFFERENCE_DEG: Final = 2.0
"""Smallest range (deg) of the vertical axis of the difference plot."""
STYLES: Final = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)
SIGNS: Final = ("—", "– –", "···")
"""Line styles of the difference, and signs that look like them: short, middle, long arm."""


class History:
    """Samples of one robot in a buffer of constant size: time (s) and angles of the arms (deg), shape (n, 4)."""

    def __init__(self, capacity: int = CAPACITY) -> None:
        # Twice the capacity: the newest samples are always contiguous, and are moved only once per `capacity` samples.
        self._rows: Samples = np.empty((2 * capacity, 1 + len(ARMS)))
        self._capacity, self._end, self._size = capacity, 0, 0

    @property
    def samples(self) -> Samples:
        """All samples, oldest first; valid until the next `add`."""
        return self._rows[self._end - self._size : self._end]

    def add(self, time_s: float, angles: tuple[float, float, float]) -> None:
        """Add a sample if it is newer than the last; a clock set back by more than GAP_S clears the samples."""
        if self._size:
            last_s = float(self._rows[self._end - 1, 0])
            if time_s == last_s:
                return
            if time_s < last_s - GAP_S:
                self._end = self._size = 0
            elif time_s < last_s:
                return
            elif time_s > last_s + GAP_S:
                self._put(last_s, (math.nan,) * 3)
        self._put(time_s, angles)

    def _put(self, time_s: float, angles: tuple[float, ...]) -> None:
        if self._end == len(self._rows):
            kept = self._capacity - 1
            self._rows[:kept] = self._rows[self._end - kept :]
            self._end = self._size = kept
        self._rows[self._end] = (time_s, *angles)
        self._end += 1
        self._size = min(self._size + 1, self._capacity)


def sample_time_s(state: RobotState, now_s: float) -> float:
    """Return the time at which positions were measured, by the monotonic clock of this computer (s)."""
    assert state.positions is not None
    stamp_s = state.positions.t_mono_ns / 1e9
    arrived_s = now_s - (state.positions_age_s or 0.0)
    return stamp_s if abs(stamp_s - arrived_s) < FOREIGN_S else arrived_s


def difference(hw: Samples, sim: Samples) -> Samples:
    """Return hardware minus simulation (deg) at the times of the hardware (s), shape (n, 4).

    NaN at times before or after the samples of the simulation; n is 0 if the simulation has fewer than two samples.
    """
    if len(sim) < 2 or len(hw) == 0:
        return np.empty((0, 1 + len(ARMS)))
    times = hw[:, 0]
    apart = hw.copy()
    for arm in range(1, 1 + len(ARMS)):
        apart[:, arm] -= np.interp(times, sim[:, 0], sim[:, arm], left=math.nan, right=math.nan)
    return apart


def span(lowest: float, highest: float, least: float) -> tuple[float, float]:
    """Return limits of an axis around these values: round numbers, at least `least` apart."""
    step = least / 4
    low, high = math.floor(lowest / step) * step, math.ceil(highest / step) * step
    missing = max(0, round((least - (high - low)) / step))
    return low - (missing - missing // 2) * step, high + missing // 2 * step


class Curves:
    """One plot: curves over the last 20 s, under a title and a legend."""

    def __init__(self, column: QVBoxLayout, title: str, least: float, names: Mapping[str, str]) -> None:
        """Add the plot to a column.

        Args:
            column: layout of the plots.
            title: quantity and unit.
            least: smallest range of the vertical axis (deg).
            names: name of each curve, by a sign that looks like its line; a curve without a name is not in the legend.
                The last curve is on top.
        """
        self._title, self._names, self._least = title, names, least
        self._label = QLabel()
        self._label.setWordWrap(True)
        self.widget = pg.PlotWidget()
        self.widget.setMinimumSize(1, 1)
        self.plot = self.widget.getPlotItem()
        column.addWidget(self._label)
        column.addWidget(self.widget, stretch=1)
        self.lines = [self.plot.plot(connect="finite", antialias=True) for _ in names]
        self._span = (0.0, 0.0)
        self.plot.setMouseEnabled(x=False, y=False)
        self.plot.setMenuEnabled(False)
        self.plot.hideButtons()
        self.plot.showGrid(x=True, y=True, alpha=0.2)
        self.plot.setXRange(-SPAN_S, 0.0, padding=0.035)  # room for the outermost labels
        self.plot.getAxis("bottom").setTicks(
            [[(second, f"{second} s".replace("-", "−")) for second in TICKS]]
        )
        self._fit([np.zeros(1)])

    def draw(self, curves: Sequence[tuple[Samples, Samples]]) -> None:
        """Draw times (s, before now) and angles (deg) of each curve."""
        for line, (times, angles) in zip(self.lines, curves, strict=True):
            line.setData(times, angles)
        self._fit([angles for _, angles in curves])

    def _fit(self, curves: Sequence[Samples]) -> None:
        values = np.concatenate(curves)
        values = values[np.isfinite(values)]
        if not len(values):
            return
        limits = span(float(values.min()), float(values.max()), self._least)
        if limits != self._span:
            self._span = limits
            self.plot.setYRange(*limits, padding=0.03)

    def show_theme(self, pens: Sequence[QPen], colours: Style) -> None:
        """Use these pens and the colours of a theme."""
        for line, pen in zip(self.lines, pens, strict=True):
            line.setPen(pen)
        lines = [
            f"<span style='color:{pen.color().name()}'>{sign}</span> {name}"
            for pen, (sign, name) in zip(pens, self._names.items(), strict=True)
            if name
        ]
        text = "&nbsp; &nbsp; ".join((f"<b>{self._title}</b>", *lines))
        self._label.setText(text)
        self._label.setStyleSheet(f"color: {colours.text}; font-size: {colours.px(12)}px")
        self.widget.setBackground(colours.field)
        font = QFont()
        font.setPixelSize(colours.px(11))
        for side in ("left", "bottom"):
            axis = self.plot.getAxis(side)
            axis.setPen(colours.edge)
            axis.setTextPen(colours.text)
            axis.setTickFont(font)
        self.plot.getAxis("left").setWidth(colours.px(34))


class PlotsPanel(QWidget):
    """A plot for each arm, thin for the simulation and wide for the hardware, and one of their difference.

    The times are the robots' own stamps, so that a lag of the hardware is visible. While the widget is hidden, samples
    are kept but not drawn.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._robot, self._histories = "", {"hw": History(), "sim": History()}
        self._now_s = 0.0
        self._drawn_s = -math.inf
        self._graphics = QWidget()
        self._graphics.setAutoFillBackground(True)
        column = QVBoxLayout(self._graphics)
        column.setContentsMargins(4, 2, 4, 2)
        column.setSpacing(0)
        sides = {"▬": texts("label.hw"), "—": texts("label.sim")}
        self.arms = [
            Curves(
                column,
                f"<span style='color:{table.hexadecimal(table.ARMS[arm])}'>●</span> "
                + texts(f"label.plot_{arm}"),
                LEAST_ARM_DEG,
                sides if arm == ARMS[0] else dict.fromkeys(sides, ""),
            )
            for arm in ARMS
        ]
        arms = {sign: texts(f"arm.{arm}") for sign, arm in zip(SIGNS, ARMS, strict=True)}
        title = f"{texts('label.difference')} (°)"
        self.difference = Curves(column, title, LEAST_DIFFERENCE_DEG, arms)
        for curves in self.arms:
            curves.plot.getAxis("bottom").setStyle(showValues=False)
        self.empty = QLabel(texts("label.plots_empty"))
        self.empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.empty.setWordWrap(True)
        self._stack = QStackedLayout(self)
        self._stack.addWidget(self.empty)
        self._stack.addWidget(self._graphics)
        self.show_theme(Theme.DARK)

    def append(self, world: World) -> None:
        """Add the newest positions, and draw them if the plots are visible."""
        self._now_s = world.now_s
        if world.robot != self._robot:
            self._robot, self._histories = world.robot, {"hw": History(), "sim": History()}
        for side, history in self._histories.items():
            state = world.side(side)
            reading = state.reading
            if reading is not None:
                arms = reading.arms
                history.add(sample_time_s(state, world.now_s), (arms.short, arms.middle, arms.long))
        if self.isVisible() and time.monotonic() - self._drawn_s > PERIOD_S:
            self._draw()

    def _draw(self) -> None:
        self._drawn_s = time.monotonic()
        hw, sim = (self._recent(history) for history in self._histories.values())
        if len(hw) or len(sim):
            self._stack.setCurrentWidget(self._graphics)
        for arm, curves in enumerate(self.arms, start=1):
            curves.draw([(rows[:, 0], rows[:, arm]) for rows in (hw, sim)])
        apart = difference(hw, sim)
        self.difference.draw([(apart[:, 0], apart[:, arm]) for arm in range(1, 1 + len(ARMS))])

    def _recent(self, history: History) -> Samples:
        """Return the shown samples, with times relative to now."""
        rows = history.samples
        rows = rows[np.searchsorted(rows[:, 0], self._now_s - SPAN_S) :].copy()
        rows[:, 0] -= self._now_s
        return rows

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        super().showEvent(event)
        self._draw()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme; lines for a projector are wider."""
        colours = style_of(theme)
        thin = 3.0 if theme is Theme.PROJECTOR else 1.5
        pale = QColor(colours.hw)
        pale.setAlphaF(0.55)
        ground = self._graphics.palette()
        ground.setColor(self._graphics.backgroundRole(), QColor(colours.field))
        self._graphics.setPalette(ground)
        pens = [pg.mkPen(pale, width=3 * thin), pg.mkPen(colours.sim, width=thin)]
        for curves in self.arms:
            curves.show_theme(pens, colours)
        self.difference.show_theme(
            [
                pg.mkPen(table.hexadecimal(table.ARMS[arm]), width=thin, style=style)
                for arm, style in zip(ARMS, STYLES, strict=True)
            ],
            colours,
        )
