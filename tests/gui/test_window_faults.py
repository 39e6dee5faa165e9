"""Faults around the window are shown until their cause is removed, and never block the window."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Self

import pytest
from gui_windows import Windowed, menu_button, windowed
from PyQt5.QtCore import Qt
from robots import Stage

from gui.console.state.saved import Saved
from gui.window.window import PERIOD_MS

SOON_S = 0.5
"""Longest time (s) from the moment at which a fault can be detected to its display."""
SILENCE_S = 0.4
"""Time (s) without positions after which a robot is silent; shorter gaps are normal on a busy network."""
GAP_S = 0.5
"""Longest time (s) between two ticks of the window's timer of 50 ms on a computer that is not busy."""
pytestmark = pytest.mark.usefixtures("qtbot")


class Gaps:
    """Measures the longest time between ticks of the window's timer, and of a thread that does nothing else.

    The thread shows how long this computer delays any program.
    """

    def __init__(self, user: Windowed) -> None:
        self._ticks: list[float] = []
        self._thread_ticks: list[float] = []
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._measure)
        user.window._timer.timeout.connect(lambda: self._ticks.append(time.monotonic()))

    def _measure(self) -> None:
        while not self._end.wait(PERIOD_MS / 1e3):
            self._thread_ticks.append(time.monotonic())

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._end.set()
        self._thread.join()

    @property
    def busy_s(self) -> float:
        """Longest delay of the thread beyond its pause (s)."""
        return longest(self._thread_ticks) - PERIOD_MS / 1e3

    def check(self) -> None:
        """Assert that the window's timer was not blocked."""
        assert len(self._ticks) > 1
        assert longest(self._ticks) < GAP_S + 2 * self.busy_s, f"this computer: {self.busy_s:.3f} s"


def longest(times: list[float]) -> float:
    return max((later - earlier for earlier, later in pairwise(times)), default=0.0)


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def shows(user: Windowed, side: str, words: str) -> Callable[[], bool]:
    """Return a function that tests whether the state of a robot contains these words."""
    return lambda: words in user.window.panels.header.pills[side].state.text()


def assert_soon(user: Windowed, holds: Callable[[], bool], what: str, gaps: Gaps, limit_s: float) -> None:
    """Wait for a condition; fail if it takes longer than `limit_s` plus the measured delays of this computer."""
    began_s = time.monotonic()
    user.until(holds, what)
    took_s = time.monotonic() - began_s
    assert took_s < limit_s + 2 * gaps.busy_s, f"{what} after {took_s:.2f} s; computer: {gaps.busy_s:.3f} s"


def test_the_window_shows_the_loss_and_the_return_of_a_robot(stage: Stage) -> None:
    hw = stage.hardware("bea")
    with windowed(stage.endpoint) as user, Gaps(user) as gaps:
        user.until(shows(user, "hw", "motors off"), "the robot is shown")
        hw.send(signal.SIGKILL)
        assert_soon(user, shows(user, "hw", "lost"), "the loss is shown", gaps, SOON_S)
        assert user.window.panels.arms.rows["short"].hw.text() == "–", "an old angle is not shown"
        user.send_to("hw")
        user.press(user.window.panels.arms.rows["short"].plus)
        assert "not online" in user.window.panels.refusal.text.text()
        stage.node("bea")
        user.until(shows(user, "hw", "motors off"), "it is back")
        user.press(user.window.panels.header.pills["hw"].next_step)
        user.until_last("enable done")
        gaps.check()


@pytest.mark.qt_log_ignore("This plugin does not support")  # popups without a display
def test_a_suspended_hardware_node_slows_neither_window_nor_simulation(stage: Stage) -> None:
    stage.simulation("bea", "--ready")
    hw = stage.hardware("bea")
    sim = stage.robot("bea", "sim")
    with windowed(stage.endpoint, saved=Saved(speed=80.0, lead_s=0.0)) as user, Gaps(user) as gaps:
        panels = user.window.panels
        user.until_ready("sim")
        user.until(shows(user, "hw", "motors off"), "the robot is shown")
        hw.send(signal.SIGSTOP)
        assert_soon(user, shows(user, "hw", "silent"), "the silence is shown", gaps, SILENCE_S + SOON_S)
        user.send_to("sim", "hw")
        user.press(menu_button(user.window, "hw", "Calibrate"))  # the hardware does not reply
        user.send_to("sim")
        user.press(panels.arms.rows["all"].plus)
        user.until_at(sim, 5, 5, 5)
        user.until_last("move", "done")
        user.press(panels.arms.rows["all"].plus)
        user.until(lambda: sim.status().moving, "it moves")
        user.key(Qt.Key.Key_Space)
        user.until(lambda: not sim.status().moving, "STOP reaches the simulation", 1.0)
        gaps.check()
        hw.send(signal.SIGCONT)
        user.until(lambda: not shows(user, "hw", "silent")(), "it is back")
        user.send_to("hw")
        user.until(lambda: "ms" in panels.header.pills["hw"].notes.text(), "it answers again")
        user.press(panels.header.pills["hw"].next_step)
        user.until_last("enable done")
