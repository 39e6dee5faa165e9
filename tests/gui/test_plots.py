"""Plots of the arms: times of the robots, bounded memory, zoom, pause, cursor, choice of curves and export."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import gui_worlds
import msgspec
import numpy as np
import pytest
from present import present
from PyQt5.QtCore import Qt
from PyQt5.QtGui import QImage
from PyQt5.QtTest import QTest
from pyqtgraph import PlotDataItem
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client import RobotState
from gui.console.state.actions import WriteFile
from gui.console.state.state import State
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.widgets.plot_samples import CAPACITY, History
from gui.window.widgets.plots import SLOTS, PlotsPanel

Arms = tuple[float, float, float]
LAG_S = 0.2


@pytest.fixture
def plots(qtbot: QtBot) -> PlotsPanel:
    made = PlotsPanel(Texts("en"))
    qtbot.addWidget(made)
    made.resize(600, 500)
    return made


def robot_at(side: str, time_s: float, arms: Arms) -> RobotState:
    state = gui_worlds.robot(side, arms=arms, age_s=0.01)
    assert state.positions is not None
    stamped = msgspec.structs.replace(state.positions, t_mono_ns=round(time_s * 1e9))
    return replace(state, positions=stamped)


def world_at(now_s: float, sim: Arms = (0, 0, 0), hw: Arms = (0, 0, 0)) -> World:
    made = gui_worlds.world(robot_at("sim", now_s - 0.01, sim), robot_at("hw", now_s - 0.01, hw))
    return replace(made, now_s=now_s)


def ramp(time_s: float) -> float:
    """Return an angle (deg) that grows by 10 deg/s from 5 s on."""
    return 10 * max(0.0, time_s - 5)


def fill(plots: PlotsPanel, arms: Callable[[float], Arms], seconds: float = 10.0) -> None:
    """Append 20 worlds a second; the hardware lags by LAG_S."""
    for tick in range(round(seconds * 20) + 1):
        now_s = tick / 20
        plots.append(world_at(now_s, arms(now_s - 0.01), arms(now_s - 0.01 - LAG_S)))


def curve(line: PlotDataItem) -> np.ndarray:
    """Return times and angles of a curve, shape (2, n)."""
    times, angles = line.getData()
    return np.array((times, angles))


def test_the_plots_show_the_lag_of_the_hardware(plots: PlotsPanel) -> None:
    fill(plots, lambda time_s: (ramp(time_s), 0, 0))
    plots.show()
    hw, sim = (curve(line) for line in plots.plots["short"].lines)
    assert sim[0, -1] == pytest.approx(-0.01), "times before now"
    assert np.interp(20.0, sim[1], sim[0]) == pytest.approx(-3.0, abs=0.01), "20 deg at 7 s of 10 s"
    assert np.interp(20.0, hw[1], hw[0]) == pytest.approx(-3.0 + LAG_S, abs=0.01)
    apart = curve(plots.plots["difference"].lines[0])
    assert apart[1, -1] == pytest.approx(-10 * LAG_S, abs=0.01), "hardware minus simulation"
    assert apart[1, 0] == pytest.approx(0.0)
    assert curve(plots.plots["middle"].lines[0])[1] == pytest.approx(0.0)


@pytest.fixture
def filled(plots: PlotsPanel) -> PlotsPanel:
    """The plots, visible, with 70 s of samples: the short arm has its time / 10 as its angle."""
    fill(plots, lambda time_s: (time_s / 10, 0, 0), 70.0)
    plots.show()
    return plots


def shown_s(plots: PlotsPanel) -> tuple[float, float]:
    """Return the times (s) at both edges of all plots."""
    (shown,) = {tuple(one.plot.viewRange()[0]) for one in plots.plots.values()}
    return shown


def move(plots: PlotsPanel, *, by_s: float = 0.0, zoom: float = 1.0, at_s: float = 0.0) -> None:
    """Drag the first plot by a time, and zoom at another, as pyqtgraph does for the mouse and its wheel."""
    box = plots.plots["short"].box
    box.translateBy(x=by_s)
    box.scaleBy(x=zoom, center=(at_s, 0.0))
    box.sigRangeChangedManually.emit([True, False])


def test_buttons_and_wheel_choose_the_time(filled: PlotsPanel) -> None:
    assert shown_s(filled) == (-20, 0)
    for seconds, button in filled.spans.items():
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        assert shown_s(filled) == (-seconds, 0)
        assert [one for one, other in filled.spans.items() if other.isChecked()] == [seconds]
    assert curve(filled.plots["short"].lines[1])[0, 0] < -59, "a whole minute is kept"
    move(filled, zoom=0.8, at_s=-10)
    begin_s, end_s = shown_s(filled)
    assert (-60 < begin_s < -30, end_s) == (True, 0), "now stays at the right edge"
    for zoom, span_s in ((100, 60), (0.001, 1)):
        move(filled, zoom=zoom, at_s=-0.5)
        assert shown_s(filled) == pytest.approx((-span_s, 0), abs=0.01)


def test_a_pause_keeps_the_picture_and_time_to_look_around(filled: PlotsPanel) -> None:
    QTest.mouseClick(filled.hold, Qt.MouseButton.LeftButton)
    before = curve(filled.plots["short"].lines[1])
    filled.append(world_at(71.0, sim=(50, 0, 0)))
    assert np.array_equal(curve(filled.plots["short"].lines[1]), before, equal_nan=True)
    move(filled, zoom=0.6, at_s=-10)
    begin_s, end_s = shown_s(filled)
    assert begin_s < -10 < end_s < 0, "the time at the mouse stays in place"
    move(filled, by_s=-100.0)
    assert shown_s(filled)[0] == pytest.approx(-60), "no time before the first is shown"
    QTest.mouseClick(filled.hold, Qt.MouseButton.LeftButton)
    assert shown_s(filled)[1] == 0
    assert curve(filled.plots["short"].lines[1])[1].max() == 50


def test_the_cursor_reads_all_curves_in_the_language(qtbot: QtBot, filled: PlotsPanel) -> None:
    german = PlotsPanel(Texts("de"))
    qtbot.addWidget(german)
    german.append(world_at(70.0))
    for panel, angle, time in ((filled, "5.0", "−20.00 s"), (german, "–", "−20,00 s")):
        panel.plots["short"].box.pointed.emit(-19.999)
        words = panel.plots["short"].label.text()
        assert panel.time.text() == time
        assert words.count(f"<b>{angle}") == 2
        panel.plots["short"].box.pointed.emit(None)
        assert panel.time.text() == ""
        assert angle not in panel.plots["short"].label.text()
    ticks = german.plots["difference"].plot.getAxis("left").tickStrings([-0.5, 0.0], 1.0, 0.5)
    assert ticks == ["−0,5", "0"]


def test_only_chosen_curves_are_shown(filled: PlotsPanel) -> None:
    choices = filled.choices
    choices["hw"].setChecked(False)
    choices["middle"].setChecked(False)
    assert [name for name, one in filled.plots.items() if one.isVisible()] == ["short", "long", "difference"]
    assert [line.isVisible() for line in filled.plots["short"].lines] == [False, True]
    assert [line.isVisible() for line in filled.plots["difference"].lines] == [True, False, True]
    assert "Middle" not in filled.plots["difference"].label.text()
    assert curve(filled.plots["short"].lines[1])[1, -1] == pytest.approx(7.0, abs=0.01)


def exported(plots: PlotsPanel, folder: Path, *suffixes: str) -> list[WriteFile]:
    """Press CSV or PNG, and choose a file; return what is written."""
    asked: list[WriteFile] = []
    plots.intent.connect(asked.append)
    for suffix in suffixes:
        QTest.mouseClick(getattr(plots, suffix), Qt.MouseButton.LeftButton)
        present(plots.dialog).fileSelected.emit(str(folder / f"plots.{suffix}"))
    return asked


def test_the_export_has_what_is_shown_with_units(filled: PlotsPanel, tmp_path: Path) -> None:
    filled.show_span(5.0)
    table, picture = exported(filled, tmp_path, "csv", "png")
    assert isinstance(table.content, str)
    header, first, *rows = table.content.splitlines()
    assert header == (
        "time_s,hw_short_deg,hw_middle_deg,hw_long_deg,sim_short_deg,sim_middle_deg,sim_long_deg"
    )
    assert len(rows) == 99
    assert [float(field) for field in first.split(",")] == pytest.approx(
        [-4.96, 6.484, 0, 0, 6.504, 0, 0], abs=0.06
    )
    assert isinstance(picture.content, bytes)
    assert QImage.fromData(picture.content).width() == filled.width()
    (write,) = State().handle(table, world_at(1.0))
    assert write == WriteFile(1, tmp_path / "plots.csv", table.content)


def choose(plots: PlotsPanel, group: str, name: str) -> None:
    """Choose one of the other values in the menu."""
    plots.menu.aboutToShow.emit()
    groups = {one.text(): one.menu() for one in plots.values.actions()}
    next(one for one in groups[group].actions() if one.text() == name).trigger()


def test_any_number_of_the_robots_can_be_shown(filled: PlotsPanel, tmp_path: Path) -> None:
    slots = [filled.plots[slot] for slot in SLOTS]
    assert not any(one.isVisible() for one in slots), "arms and their difference are the default"
    choose(filled, "board", "boot")
    choose(filled, "velocity", "short")
    assert [one.isVisible() for one in slots] == [True, True, False]
    assert "velocity short (°/s)" in slots[1].label.text()
    fill(filled, lambda _: (0, 0, 0), 2.0)
    hw, sim = (curve(line) for line in slots[0].lines)
    assert hw[1, -1] == sim[1, -1] == 1
    choose(filled, "velocity", "short")
    choose(filled, "head", "pitch")
    choose(filled, "head", "roll")
    choose(filled, "lease", "frozen")
    assert "boot" not in slots[0].label.text(), "the first choice makes room for a fourth"
    (saved,) = exported(filled, tmp_path, "csv")
    assert "time_s,hw_short_deg,hw_middle_deg,hw_long_deg,hw_frozen,hw_head.pitch," in str(saved.content)


def test_the_memory_of_the_samples_is_bounded() -> None:
    history = History()
    for tick in range(10_000):
        history.add(tick / 50, (tick, 0, 0))
    assert history.samples(0.0)[:, 1].tolist() == list(range(10_000 - CAPACITY, 10_000)), (
        "the newest, in order"
    )
