"""Plots of the arms: times of the robots, bounded memory, and no drawing while hidden."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import gui_worlds
import msgspec
import numpy as np
import pytest
from pyqtgraph import PlotDataItem
from pytestqt.qtbot import QtBot

from beatrix_zenoh.client import RobotState
from gui.console.state.world import World
from gui.console.texts import Texts
from gui.window.widgets import plots as plots_module
from gui.window.widgets.plots import CAPACITY, History, PlotsPanel, sample_time_s, span

Arms = tuple[float, float, float]
LAG_S = 0.2


@pytest.fixture
def plots(qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> PlotsPanel:
    monkeypatch.setattr(plots_module, "PERIOD_S", 0.0)
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
    hw, sim = (curve(line) for line in plots.arms[0].lines)
    assert sim[0, -1] == pytest.approx(-0.01), "times before now"
    assert np.interp(20.0, sim[1], sim[0]) == pytest.approx(-3.0, abs=0.01), "20 deg at 7 s of 10 s"
    assert np.interp(20.0, hw[1], hw[0]) == pytest.approx(-3.0 + LAG_S, abs=0.01)
    apart = curve(plots.difference.lines[0])
    assert apart[1, -1] == pytest.approx(-10 * LAG_S, abs=0.01), "hardware minus simulation"
    assert apart[1, 0] == pytest.approx(0.0)
    assert curve(plots.arms[1].lines[0])[1] == pytest.approx(0.0)


def test_curves_are_drawn_at_most_20_times_a_second(
    plots: PlotsPanel, monkeypatch: pytest.MonkeyPatch
) -> None:
    plots.append(world_at(1.0))
    plots.show()
    monkeypatch.setattr(plots_module, "PERIOD_S", 60.0)
    plots.append(world_at(1.05))
    assert len(curve(plots.arms[0].lines[0])[0]) == 1
    monkeypatch.setattr(plots_module, "PERIOD_S", 0.0)
    plots.append(world_at(1.1))
    assert len(curve(plots.arms[0].lines[0])[0]) == 3, "no sample is lost"


def test_time_stamps_of_another_computer_are_converted_to_this_clock() -> None:
    state = robot_at("hw", 99.9, (0, 0, 0))
    assert sample_time_s(state, 100.0) == pytest.approx(99.9)
    foreign = robot_at("hw", 5099.9, (0, 0, 0))
    assert sample_time_s(foreign, 100.0) == pytest.approx(99.99), "the time of arrival"


@pytest.mark.parametrize(
    ("lowest", "highest", "limits"), [(0, 0, (-10, 10)), (-1, 62, (-5, 65)), (40, 41, (30, 50))]
)
def test_an_axis_has_round_limits(lowest: float, highest: float, limits: tuple[float, float]) -> None:
    low, high = span(lowest, highest, 20.0)
    assert (low, high) == limits


def test_the_memory_of_the_samples_is_bounded() -> None:
    def memory(history: History) -> int:
        """Return the bytes behind the samples. (Beside threads of Zenoh, tracemalloc of Python 3.11 can crash.)"""
        return history.samples.nbytes if history.samples.base is None else history.samples.base.nbytes

    def feed(first: int, count: int) -> None:
        for tick in range(first, first + count):
            history.add(tick / 50, (tick, 0, 0))

    history = History()
    feed(0, 5_000)
    kept = memory(history)
    feed(5_000, 100_000)
    assert memory(history) == kept
    assert len(history.samples) == CAPACITY
    assert history.samples[:, 1].tolist() == list(range(105_000 - CAPACITY, 105_000)), "the newest, in order"
