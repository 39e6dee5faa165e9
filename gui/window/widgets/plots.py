"""Arm angles of both robots over time, their difference, and any other value: zoom, pause, cursor, choice of curves and export."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Final

import pyqtgraph as pg
from PyQt5.QtCore import QBuffer, QIODevice, Qt
from PyQt5.QtGui import QCloseEvent, QColor, QResizeEvent, QShowEvent
from PyQt5.QtWidgets import QAction, QFileDialog, QGridLayout, QMenu, QPushButton, QWidget

from beatrix_zenoh import colours as hues
from beatrix_zenoh.client import RobotState
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.contract.values import Value
from gui.console.state.actions import NEW, WriteFile
from gui.console.state.intents import Theme
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import NO_MARGINS, in_column, in_row, label, plain_button, spaced
from gui.window.widgets.files import FilePanel
from gui.window.widgets.plot_curves import Curves
from gui.window.widgets.plot_samples import (
    SPAN_MAX_S,
    History,
    Samples,
    between,
    difference,
    numbers,
    sample_time_s,
    table,
)

BOTH: Final = ("hw", "sim")
"""The robots in the order in which they are drawn."""
DIFFERENCE: Final = "difference"
SPANS: Final = (5, 20, 60)
"""Times that the plots show at the press of a button (s)."""
SPAN_S: Final = 20.0
"""Time that the plots show at first."""
LEAST_ARM_DEG: Final = 20.0
"""Smallest range (deg) of the vertical axis of an arm's plot."""
LEAST_VALUE: Final = 1.0
"""Smallest range of the vertical axis of another value's plot."""
SLOTS: Final = ("value 1", "value 2", "value 3")
"""Plots of other values."""
COLUMNS: Final = (*ARMS, *SLOTS)
"""What the samples contain beside their time."""
LEAST_DIFFERENCE_DEG: Final = 2.0
"""Smallest range (deg) of the vertical axis of the difference plot."""
STYLES: Final = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)
SIGNS: Final = ("—", "–&nbsp;–", "···")
"""Line styles of the difference, and signs that look like them: short, middle, long arm."""
LOW: Final = 20
"""Height of the panel, in lines of text, below which the plots stand in two columns."""


class PlotsPanel(FilePanel):
    """A plot for each arm, thin for the simulation and wide for the hardware, and one of their difference.

    The user can also choose other numbers that the robots publish.

    The times are the robots' own stamps, so that a lag of the hardware is visible. While the widget is hidden or
    paused, samples are kept but not drawn.
    """

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._robot, self._histories = "", {side: History(COLUMNS) for side in BOTH}
        self._watched: dict[str, Value] = {}
        """the other values that are shown, by slot"""
        self._now_s = 0.0
        self._begin_s = self._end_s = 0.0
        """the shown times, before now or before the pause"""
        self._paused: dict[str, Samples] | None = None
        """the samples while the plots are paused"""
        self._cursor_s: float | None = None
        self._states: dict[str, RobotState] = {}
        bar = self._bar(texts)
        self._graphics = QWidget()
        self._graphics.setAutoFillBackground(True)
        self.plots = self._made_plots(texts)
        """by arm, slot, and DIFFERENCE; those of the slots are hidden until the user chooses other values"""
        self._grid = spaced(QGridLayout(self._graphics), None, (4, 2, 4, 2))
        self._grid.setVerticalSpacing(0)
        in_column(bar, (self._graphics, 1), gap=0, margins=NO_MARGINS, inside=self)
        for curves in self.plots.values():
            curves.box.pointed.connect(self._point)
            curves.moved.connect(self._show_times)
        self.show_theme(Theme.DARK)
        self.show_span(SPAN_S)

    def _made_plots(self, texts: Texts) -> dict[str, Curves]:
        signs = ("▬", "—")
        sides = [(sign, texts(f"label.{side}")) for sign, side in zip(signs, BOTH, strict=True)]
        arms = [(sign, texts(f"arm.{arm}")) for sign, arm in zip(SIGNS, ARMS, strict=True)]
        plots = dict[str, Curves]()
        for arm in ARMS:  # the first one names the robots
            dot = f"<span style='color:{hues.hexadecimal(hues.ARMS[arm])}'>●</span>"
            names = [(sign, "") for sign in signs] if plots else sides
            title = f"{dot} {texts(f'label.plot_{arm}')}"
            plots[arm] = Curves(self._graphics, texts, title, LEAST_ARM_DEG, names)
        for slot in SLOTS:
            plots[slot] = Curves(self._graphics, texts, "", LEAST_VALUE, sides)
        title = f"{texts('label.difference')} (°)"
        plots[DIFFERENCE] = Curves(self._graphics, texts, title, LEAST_DIFFERENCE_DEG, arms)
        return plots

    def _bar(self, texts: Texts) -> QWidget:
        """Return the buttons above the plots."""
        self.spans = {
            seconds: self._button(f"{seconds} s", "plot_span", seconds=str(seconds)) for seconds in SPANS
        }
        for seconds, button in self.spans.items():
            button.setCheckable(True)
            button.clicked.connect(lambda _, seconds=seconds: self.show_span(seconds))
        self.hold = self._button(texts("plot.pause"), "plot_pause")
        self.hold.setCheckable(True)
        self.hold.clicked.connect(self.pause)
        self.menu = QMenu(self)
        self.menu.aboutToShow.connect(self._offer)
        self.choices = {
            name: self._choice(
                self.menu, texts(f"arm.{name}" if name in ARMS else f"label.{name}"), self._choose
            )
            for name in (*BOTH, *ARMS, DIFFERENCE)
        }
        """by side, arm or DIFFERENCE"""
        self.menu.addSeparator()
        self.values = self.menu.addMenu(texts("plot.values"))
        """the values of the robots, in groups; `_offer` fills it"""
        curves = self._button(f"{texts('plot.curves')} ▾", "plot_curves")
        # Without blocking the window, as `setMenu` would.
        curves.clicked.connect(lambda: self.menu.popup(curves.mapToGlobal(curves.rect().bottomLeft())))
        self.time = label(role="dim")
        """time at the cursor"""
        self.csv, self.png = (self._button(kind.upper(), f"plot_{kind}") for kind in ("csv", "png"))
        self.csv.clicked.connect(self._export_table)
        self.png.clicked.connect(self._export_picture)
        short, middle, long = self.spans.values()
        parts = short, middle, long, self.hold, curves, (self.time, 1), self.csv, self.png
        bar = QWidget()
        in_row(*parts, gap=4, margins=(4, 4, 4, 0), inside=bar)
        return bar

    def _button(self, text: str, tip: str, **slots: str) -> QPushButton:
        """Return a button whose tooltip is also its name, because its text is too short."""
        tooltip = self._texts(f"tip.{tip}", **slots)
        return plain_button(text, tooltip, tooltip)

    @staticmethod
    def _choice(menu: QMenu, text: str, do: Callable[[bool], None], *, on: bool = True) -> QAction:
        """Return a new entry of a menu that is on or off, and does something with each change."""
        action = menu.addAction(text)
        action.setCheckable(True)
        action.setChecked(on)
        action.toggled.connect(do)
        return action

    def _chosen(self, name: str) -> bool:
        """Return whether a side, an arm or the difference is shown."""
        return self.choices[name].isChecked()

    # -- samples ------------------------------------------------------------------------------------

    def append(self, world: World) -> None:
        """Add the newest positions, and draw them if the plots are visible and not paused."""
        if world.robot != self._robot:
            self._robot, self._histories = world.robot, {side: History(COLUMNS) for side in BOTH}
            self.pause(on=False)
        for side, history in self._histories.items():
            state = self._states[side] = world.side(side)
            if state.reading is not None:
                values = *state.reading.arms, *self._others(state)
                history.add(sample_time_s(state, world.now_s), values)
        self._now_s = world.now_s
        if self._paused is None and self.isVisible():
            self._draw()

    def _others(self, state: RobotState) -> list[float]:
        """Return the present values of all slots; NaN of an empty one, and of a value that this robot does not have."""
        found = numbers(state) if self._watched else {}
        present = [found.get(self._watched[slot].field) if slot in self._watched else None for slot in SLOTS]
        return [math.nan if value is None else value.number for value in present]

    def _offer(self) -> None:
        """Offer all numbers of both robots in the menu."""
        self.values.clear()
        found: dict[str, Value] = {}
        for state in self._states.values():
            found |= numbers(state)
        groups: dict[str, QMenu] = {}
        for value in found.values():
            if value.group not in groups:
                groups[value.group] = self.values.addMenu(self._texts.word(value.group))
            on = value.field in {watched.field for watched in self._watched.values()}
            watch = partial(self.watch, value)
            self._choice(groups[value.group], self._texts.word(value.title), watch, on=on)

    def watch(self, value: Value, on: bool) -> None:  # noqa: FBT001 - Qt's signal has it
        """Show a value from now on in a slot, if all are in use in that of the value chosen first; or show it no longer."""
        slots = [slot for slot, shown in self._watched.items() if shown.field == value.field]
        free = [slot for slot in SLOTS if slot not in self._watched] or [*self._watched]
        for slot in slots or free[:1]:
            self._watched.pop(slot, None)
            for history in self._histories.values():
                history.forget(slot)
            if on:
                self._watched[slot] = value
        self._choose()

    def _samples(self) -> dict[str, Samples]:
        """Return the samples of the chosen robots, with times before now or before the pause."""
        found = self._present() if self._paused is None else self._paused
        return {side: rows if self._chosen(side) else rows[:0] for side, rows in found.items()}

    def _present(self) -> dict[str, Samples]:
        return {side: history.samples(self._now_s) for side, history in self._histories.items()}

    def _draw(self) -> None:
        samples = self._samples()
        hw, sim = (between(samples[side], self._begin_s, self._end_s) for side in BOTH)
        apart = difference(hw, sim)
        for name, curves in self.plots.items():
            if name == DIFFERENCE:
                shown = [(apart[:, 0], apart[:, column]) for column in range(1, 1 + len(ARMS))]
            else:
                shown = [(rows[:, 0], rows[:, 1 + COLUMNS.index(name)]) for rows in (hw, sim)]
            if self._shown(name):
                curves.draw(shown, self._cursor_s)
        at_s = self._cursor_s
        self.time.setText("" if at_s is None else self._texts("plot.time", seconds=at_s))

    # -- what is shown ------------------------------------------------------------------------------

    def show_span(self, seconds: float) -> None:
        """Show this time (s) before now or, while paused, before the right edge."""
        self._show_times(max(-SPAN_MAX_S, self._end_s - seconds), self._end_s)

    def pause(self, on: bool) -> None:  # noqa: FBT001 - Qt's signal has it
        """Keep the present samples on the screen, or follow the robots again."""
        if on != (self._paused is not None):
            self._paused = self._present() if on else None
            self.hold.setChecked(on)
            self._show_times(self._begin_s, self._end_s)

    def _show_times(self, begin_s: float, end_s: float) -> None:
        """Show these times (s, before now or before the pause) in all plots; without a pause, up to now."""
        if self._paused is None:
            begin_s, end_s = begin_s - end_s, 0.0
        self._begin_s, self._end_s = begin_s, end_s
        for curves in self.plots.values():
            curves.box.setXRange(begin_s, end_s, padding=0.0)
        for seconds, button in self.spans.items():
            button.setChecked(math.isclose(end_s - begin_s, seconds))
        self._point(self._cursor_s)

    def _point(self, time_s: float | None) -> None:
        """Show the values at a time (s), if it is shown."""
        inside = time_s is not None and self._begin_s <= time_s <= self._end_s
        self._cursor_s = time_s if inside else None
        self._draw()

    def _choose(self, _changed: object = None) -> None:
        """Show the chosen plots and curves."""
        for slot, value in self._watched.items():
            words = " ".join(self._texts.word(part) for part in (value.group, value.title))
            self.plots[slot].title = f"{words} ({value.unit})" if value.unit else words
        for name, curves in self.plots.items():
            curves.choose([self._chosen(part) for part in (ARMS if name == DIFFERENCE else BOTH)])
            curves.setVisible(self._shown(name))
        self._arrange()
        self._draw()

    def _shown(self, name: str) -> bool:
        return name in self._watched if name in SLOTS else self._chosen(name)

    def _arrange(self) -> None:
        """Put the chosen plots into one column or, in a low panel, into two; the lowest have the labels of the time."""
        shown = [curves for name, curves in self.plots.items() if self._shown(name)]
        columns = 1 if self.height() >= LOW * self.fontMetrics().lineSpacing() else 2
        for number, curves in enumerate(shown):
            self._grid.addWidget(curves, *divmod(number, columns))
            curves.show_time_axis(shown=number + columns >= len(shown))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._arrange()

    # -- export -------------------------------------------------------------------------------------

    def _export_table(self) -> None:
        names = {arm: f"{arm}_deg" for arm in ARMS}
        names |= {slot: self._watched[slot].field for slot in SLOTS if slot in self._watched}
        columns = [0, *(1 + COLUMNS.index(name) for name in names)]
        samples = {side: rows[:, columns] for side, rows in self._samples().items() if self._chosen(side)}
        self._save("plot_csv", table(samples, [*names.values()], self._begin_s, self._end_s))

    def _export_picture(self) -> None:
        buffer = QBuffer()
        buffer.open(QIODevice.OpenModeFlag.WriteOnly)
        self._graphics.grab().save(buffer, "PNG")
        self._save("plot_png", bytes(buffer.data()))

    def _save(self, kind: str, content: str | bytes) -> None:
        """Let the user choose the file; the content is that of the moment of the press."""
        title, suffix = self._texts(f"tip.{kind}"), kind.removeprefix("plot_")
        save = QFileDialog.AcceptMode.AcceptSave
        self.choose_file(title, save, suffix, lambda file: WriteFile(NEW, file, content))

    # -- appearance ---------------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        super().showEvent(event)
        self._draw()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Take the plots apart; pyqtgraph can fail if Qt does it, because their parts know each other."""
        super().closeEvent(event)
        for curves in self.plots.values():
            curves.area.close()

    def show_theme(self, theme: Theme) -> None:
        """Use the colours of a theme; lines for a projector are wider."""
        colours, thin = style_of(theme), 3.0 if theme is Theme.PROJECTOR else 1.5
        pale = QColor(colours.hw)
        pale.setAlphaF(0.55)
        ground = self._graphics.palette()
        ground.setColor(self._graphics.backgroundRole(), QColor(colours.field))
        self._graphics.setPalette(ground)
        sides = [pg.mkPen(pale, width=3 * thin), pg.mkPen(colours.sim, width=thin)]
        arms = [
            pg.mkPen(hues.hexadecimal(hues.ARMS[arm]), width=thin, style=style)
            for arm, style in zip(ARMS, STYLES, strict=True)
        ]
        for name, curves in self.plots.items():
            curves.show_theme(arms if name == DIFFERENCE else sides, colours)
        self._choose()
