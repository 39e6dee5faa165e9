"""Arm angles of both robots over time, and their difference: zoom, pause, cursor, choice of curves and export."""

from __future__ import annotations

import math
import time
from typing import Final

import pyqtgraph as pg
from PyQt5.QtCore import QBuffer, QIODevice, QPoint, Qt
from PyQt5.QtGui import QColor, QResizeEvent, QShowEvent
from PyQt5.QtWidgets import (
    QAction,
    QFileDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QStackedLayout,
    QVBoxLayout,
    QWidget,
)

from beatrix_zenoh import colours as hues
from beatrix_zenoh.contract.names import ARMS, SIDES
from gui.console.state.actions import NEW, WriteFile
from gui.console.state.intents import Theme
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import NO_MARGINS, label, plain_button, set_text, spaced
from gui.window.widgets.files import FilePanel
from gui.window.widgets.plot_curves import Curves, Name
from gui.window.widgets.plot_samples import (
    SPAN_MAX_S,
    History,
    Samples,
    between,
    difference,
    sample_time_s,
    table,
)

SPANS: Final = (5, 20, 60)
"""Times that the plots show at the press of a button (s)."""
SPAN_S: Final = 20.0
"""Time that the plots show at first."""
SPAN_MIN_S: Final = 1.0
PERIOD_S: Final = 0.045
"""Shortest time between two drawings: 20 a second with some slack."""
LEAST_ARM_DEG: Final = 20.0
"""Smallest range (deg) of the vertical axis of an arm's plot."""
LEAST_DIFFERENCE_DEG: Final = 2.0
"""Smallest range (deg) of the vertical axis of the difference plot."""
STYLES: Final = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)
SIGNS: Final = ("—", "– –", "···")
"""Line styles of the difference, and signs that look like them: short, middle, long arm."""
BOTH: Final = ("hw", "sim")
"""The robots in the order in which they are drawn."""
DIFFERENCE: Final = "difference"
LOW: Final = 20
"""Height of the panel, in lines of text, below which the plots stand in two columns."""


def described(text: str, tooltip: str) -> QPushButton:
    """Return a button whose text is too short to be its name."""
    return plain_button(text, tooltip, tooltip)


class PlotBar(QWidget):
    """The buttons above the plots."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
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


class PlotsPanel(FilePanel):
    """A plot for each arm, thin for the simulation and wide for the hardware, and one of their difference.

    The times are the robots' own stamps, so that a lag of the hardware is visible. While the widget is hidden or
    paused, samples are kept but not drawn.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._robot, self._histories = "", {side: History() for side in BOTH}
        self._now_s = 0.0
        self._drawn_s = -math.inf
        self._begin_s, self._end_s = -SPAN_S, 0.0
        """the shown times, before now or before the pause"""
        self._paused: dict[str, Samples] | None = None
        """the samples while the plots are paused"""
        self._cursor_s: float | None = None
        self.bar = PlotBar(texts)
        self._graphics = QWidget()
        self._graphics.setAutoFillBackground(True)
        self.plots = self._made_plots(texts)
        """by arm, and DIFFERENCE"""
        self.empty = label(texts("label.plots_empty"), wrap=True)
        self.empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._lay_out()
        self._connect()
        self._choose()
        self._show_times()
        self.show_theme(Theme.DARK)

    @property
    def arms(self) -> list[Curves]:
        """The plots of the arms."""
        return [self.plots[arm] for arm in ARMS]

    @property
    def difference(self) -> Curves:
        """The plot of the difference."""
        return self.plots[DIFFERENCE]

    @staticmethod
    def _made_plots(texts: Texts) -> dict[str, Curves]:
        sides = (Name("▬", texts("label.hw")), Name("—", texts("label.sim")))
        unnamed = tuple(name._replace(text="") for name in sides)
        plots = {
            arm: Curves(
                texts,
                f"<span style='color:{hues.hexadecimal(hues.ARMS[arm])}'>●</span> "
                + texts(f"label.plot_{arm}"),
                LEAST_ARM_DEG,
                sides if arm == ARMS[0] else unnamed,
            )
            for arm in ARMS
        }
        arms = [Name(sign, texts(f"arm.{arm}")) for sign, arm in zip(SIGNS, ARMS, strict=True)]
        return plots | {
            DIFFERENCE: Curves(texts, f"{texts('label.difference')} (°)", LEAST_DIFFERENCE_DEG, arms)
        }

    def _lay_out(self) -> None:
        self._grid = spaced(QGridLayout(self._graphics), None, (4, 2, 4, 2))
        self._grid.setVerticalSpacing(0)
        self.none: QLabel = label(self._texts("label.plots_none"), wrap=True)
        self.none.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._grid.addWidget(self.none, len(self.plots), 0)
        drawing = QWidget()
        inner = spaced(QVBoxLayout(drawing), 0, NO_MARGINS)
        inner.addWidget(self.bar)
        inner.addWidget(self._graphics, 1)
        self._stack = QStackedLayout(self)
        self._stack.addWidget(self.empty)
        self._stack.addWidget(drawing)

    def _connect(self) -> None:
        for seconds, button in self.bar.spans.items():
            button.clicked.connect(lambda _, seconds=seconds: self.show_span(float(seconds)))
        self.bar.pause.clicked.connect(self.pause)
        for action in self.bar.choices.values():
            action.toggled.connect(self._choose)
        self.bar.csv.clicked.connect(self._export_table)
        self.bar.png.clicked.connect(self._export_picture)
        for curves in self.plots.values():
            curves.mouse.pointed.connect(self._point)
            curves.mouse.zoomed.connect(self._zoom)
            curves.mouse.dragged.connect(self._drag)

    # -- samples ------------------------------------------------------------------------------------

    def append(self, world: World) -> None:
        """Add the newest positions, and draw them if the plots are visible and not paused."""
        if world.robot != self._robot:
            self._robot, self._histories = world.robot, {side: History() for side in BOTH}
            self.pause(on=False)
        for side, history in self._histories.items():
            state = world.side(side)
            reading = state.reading
            if reading is not None:
                arms = reading.arms
                history.add(sample_time_s(state, world.now_s), (arms.short, arms.middle, arms.long))
        self._now_s = world.now_s
        if self._paused is None and self.isVisible() and time.monotonic() - self._drawn_s > PERIOD_S:
            self._draw()

    def keep(self, before: PlotsPanel) -> None:
        """Go on with the samples, times and choices of a panel in another language."""
        self._robot, self._histories, self._now_s = before._robot, before._histories, before._now_s
        self._paused, self._begin_s, self._end_s = before._paused, before._begin_s, before._end_s
        for name, action in self.bar.choices.items():
            action.setChecked(before.bar.chosen(name))
        self.bar.pause.setChecked(self._paused is not None)
        self._show_times()

    def _samples(self) -> dict[str, Samples]:
        """Return the samples of the chosen robots, with times before now or before the pause."""
        found = self._present() if self._paused is None else self._paused
        return {side: rows if self.bar.chosen(side) else rows[:0] for side, rows in found.items()}

    def _present(self) -> dict[str, Samples]:
        found = {side: history.samples.copy() for side, history in self._histories.items()}
        for rows in found.values():
            rows[:, 0] -= self._now_s
        return found

    def _draw(self) -> None:
        self._drawn_s = time.monotonic()
        samples = self._samples()
        if any(len(history.samples) for history in self._histories.values()):
            self._stack.setCurrentIndex(1)
        hw, sim = (between(samples[side], self._begin_s, self._end_s) for side in BOTH)
        for name, curves in self.plots.items():
            if curves.isHidden():
                continue
            if name == DIFFERENCE:
                apart = difference(hw, sim)
                curves.draw([(apart[:, 0], apart[:, arm]) for arm in range(1, 1 + len(ARMS))])
            else:
                curves.draw([(rows[:, 0], rows[:, 1 + ARMS.index(name)]) for rows in (hw, sim)])
        if self._cursor_s is not None:
            self._read()

    # -- what is shown ------------------------------------------------------------------------------

    def show_span(self, seconds: float) -> None:
        """Show this time (s) before now or, while paused, before the right edge."""
        self._begin_s = max(-SPAN_MAX_S, self._end_s - min(max(seconds, SPAN_MIN_S), SPAN_MAX_S))
        self._show_times()

    def pause(self, on: bool) -> None:  # noqa: FBT001 - Qt's signal has it
        """Keep the present samples on the screen, or follow the robots again."""
        if on == (self._paused is not None):
            return
        self._paused = self._present() if on else None
        if not on:
            self._begin_s, self._end_s = self._begin_s - self._end_s, 0.0
        self.bar.pause.setChecked(on)
        self._show_times()

    def _show_times(self) -> None:
        shown_s = self._end_s - self._begin_s
        for seconds, button in self.bar.spans.items():
            button.setChecked(math.isclose(shown_s, seconds))
        for curves in self.plots.values():
            curves.show_times(self._begin_s, self._end_s)
        self._point(self._cursor_s)
        self._draw()

    def _zoom(self, factor: float, at_s: float) -> None:
        """Show less or more time; while paused, the time at the mouse stays in place."""
        shown_s = self._end_s - self._begin_s
        wanted_s = min(max(shown_s * factor, SPAN_MIN_S), SPAN_MAX_S)
        if self._paused is not None:
            share = min(max((self._end_s - at_s) / shown_s, 0.0), 1.0)
            self._end_s = min(0.0, at_s + share * wanted_s)
        self.show_span(wanted_s)

    def _drag(self, by_s: float) -> None:
        """While paused, show earlier or later times."""
        if self._paused is None:
            return
        by_s = min(max(by_s, self._end_s), self._begin_s + SPAN_MAX_S)
        self._begin_s, self._end_s = self._begin_s - by_s, self._end_s - by_s
        self._show_times()

    def _point(self, time_s: float | None) -> None:
        inside = time_s is not None and self._begin_s <= time_s <= self._end_s
        self._cursor_s = time_s if inside else None
        self._read()

    def _read(self) -> None:
        """Show the values at the cursor."""
        for curves in self.plots.values():
            curves.read(self._cursor_s)
        at_s = self._cursor_s
        set_text(self.bar.time, "" if at_s is None else self._texts("plot.time", seconds=at_s))

    def _choose(self) -> None:
        """Show the chosen plots."""
        for name, curves in self.plots.items():
            curves.choose([self.bar.chosen(part) for part in (ARMS if name == DIFFERENCE else BOTH)])
            curves.setVisible(self.bar.chosen(name))
        self._arrange()
        self._draw()

    def _arrange(self) -> None:
        """Put the chosen plots into one column or, in a low panel, into two; the lowest have the labels of the time."""
        shown = [curves for name, curves in self.plots.items() if self.bar.chosen(name)]
        columns = 1 if self.height() >= LOW * self.fontMetrics().lineSpacing() else 2
        for number, curves in enumerate(shown):
            self._grid.addWidget(curves, *divmod(number, columns))
            curves.show_time_axis(shown=number + columns >= len(shown))
        self.none.setVisible(not shown)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    # -- export -------------------------------------------------------------------------------------

    def _export_table(self) -> None:
        samples = {side: rows for side, rows in self._samples().items() if self.bar.chosen(side)}
        self._save("plot_csv", table(samples, self._begin_s, self._end_s))

    def _export_picture(self) -> None:
        buffer = QBuffer()
        buffer.open(QIODevice.OpenModeFlag.WriteOnly)
        self._graphics.grab().save(buffer, "PNG")
        self._save("plot_png", bytes(buffer.data()))

    def _save(self, kind: str, content: str | bytes) -> None:
        """Let the user choose the file; the content is that of the moment of the press."""
        title, suffix = self._texts(f"tip.{kind}"), kind.removeprefix("plot_")
        save = QFileDialog.AcceptMode.AcceptSave
        self.choose_file(title, save, suffix, lambda file: WriteFile(NEW, file, content), files=kind)

    # -- appearance ---------------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        super().showEvent(event)
        self._draw()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme; lines for a projector are wider."""
        colours = style_of(theme)
        self._arrange()
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
                pg.mkPen(hues.hexadecimal(hues.ARMS[arm]), width=thin, style=style)
                for arm, style in zip(ARMS, STYLES, strict=True)
            ],
            colours,
        )
