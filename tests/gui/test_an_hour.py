"""An hour of work, shortened: memory is bounded, and no threads are added."""

from __future__ import annotations

import gc
import threading
import tracemalloc
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import simplejpeg
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink
from window_views import ready
from worlds import positions

from beatrix_zenoh._generated.messages import Event, EventKind
from beatrix_zenoh.client import CameraImage, RobotState
from gui.state.actions import Outcome, Send
from gui.state.history import SHOWN
from gui.state.intents import Jog, ShowTab, Tab
from gui.state.memory import KEPT
from gui.state.state import State
from gui.state.world import World
from gui.widgets.plots import CAPACITY
from gui.window import Window

HOUR_S = 3600
HZ = 2
"""Refreshes a second; a tenth of the window's, which fill the same rows several times."""
ROUNDS = 500
"""Requests of this window in the hour."""
COUNTED = (60, 280, ROUNDS)
"""Rounds at which counting starts, and at which memory is measured: every list is full of counted rows at the first."""
EVENTS = 70
"""Events kept of each robot; every third request has one of another seat."""
GROWTH = 100_000
"""Bytes by which the memory of our modules may grow between both measurements."""
LARGE = 16_384
"""Size (bytes) of a large block; pictures of this test take less."""
JPEG: bytes = simplejpeg.encode_jpeg(np.zeros((48, 64, 3), np.uint8))
GUI = str(Path(__file__).resolve().parents[2] / "gui" / "*")


def at(world: World, passed_s: float, events: tuple[Event, ...]) -> World:
    """Return the world at a time of the hour, with moving robots."""
    arms = (passed_s % 60, -(passed_s % 30), passed_s % 20)
    now_s = 100.0 + passed_s
    place = msgspec.structs.replace(positions(arms), t_mono_ns=round(now_s * 1e9))

    def moved(robot: RobotState) -> RobotState:
        return replace(robot, positions=place, events=events)

    return replace(
        world, now_s=now_s, wall_s=1_000_000.0 + passed_s, sim=moved(world.sim), hw=moved(world.hw)
    )


def request_of_another(number: int, passed_s: float) -> Event:
    """Return an event of another seat."""
    t_ns = round(passed_s * 1e9)
    kind, seat = EventKind.COMMAND, f"seat-{number % 30}"
    return Event(seq=number, t_mono_ns=t_ns, t_wall_ns=10**15 + t_ns, kind=kind, action="enable", seat=seat)


def picture(number: int, passed_s: float) -> CameraImage:
    """Return a picture of an eye of the simulation."""
    return CameraImage(
        JPEG, "left", number, round(passed_s * 1e9), 0, 64, 48, "egl", round(passed_s * 1e9), 0
    )


def held() -> int:
    """Return the number of bytes that modules of this project have allocated and still use, without large blocks.

    PyQt finds its objects in a table, one block, which it doubles when the objects of all tests have filled it.
    """
    gc.collect()  # in a process with many objects it runs too seldom by itself
    snapshot = tracemalloc.take_snapshot().filter_traces(
        [tracemalloc.Filter(inclusive=True, filename_pattern=GUI)]
    )
    return sum(trace.size for trace in snapshot.traces if trace.size < LARGE)


@pytest.mark.no_cover
def test_an_hour(qtbot: QtBot, window: Window, link: RecordingLink, state: State) -> None:
    threads, base = threading.active_count(), ready()
    events: list[Event] = []
    found: list[int] = []
    for number in range(1, ROUNDS + 1):
        passed_s = number * HOUR_S / ROUNDS
        if number % 3 == 0:
            events = [*events, request_of_another(number, passed_s)][-EVENTS:]
        link.known = at(base, passed_s, tuple(events))
        link.done.clear()
        window.handle(Jog("short", 1))
        (sent,) = link.done
        assert isinstance(sent, Send)
        for twin in sent.twins:
            window.report(Outcome(sent.row, twin, accepted=True, done=True, duration_s=1.0))
        window.handle(ShowTab(list(Tab)[number // 20 % len(Tab)]))
        for seq in range(3):
            window.show_image("sim", picture(3 * number + seq, passed_s))
        if number % 20 == 0:
            qtbot.wait(1)
        if number == COUNTED[0]:
            tracemalloc.start()
        elif number in COUNTED:
            found.append(held())
    tracemalloc.stop()
    assert len(state._memory.rows) == KEPT < ROUNDS
    assert len(state._memory.undo) < KEPT
    assert window.panels.history.list.count() == SHOWN
    assert found[1] - found[0] < GROWTH, found
    assert threading.active_count() == threads


def test_the_plots_of_an_hour(window: Window) -> None:
    plots, base = window.panels.plots, ready()
    sizes = [history._rows.nbytes for history in plots._histories.values()]
    for tick in range(HOUR_S * HZ):
        plots.append(at(base, tick / HZ, ()))
    assert [history._rows.nbytes for history in plots._histories.values()] == sizes
    for history in plots._histories.values():
        assert len(history.samples) == CAPACITY
        assert history.samples[-1, 0] == 100.0 + HOUR_S - 1 / HZ
