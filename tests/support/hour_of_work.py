"""Simulate an hour of work in the window, shortened; print what the window keeps at its end, as JSON.

It needs a process of its own. In a process with the objects of other tests, PyQt's table of all objects may become full
and be doubled, which looks like a leak; and tracemalloc of Python 3.11 crashes if it stops while a thread of Zenoh
allocates memory.
"""

from __future__ import annotations

import gc
import json
import threading
import tracemalloc
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import simplejpeg
from gui_views import ready
from gui_worlds import positions
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication
from recording_link import RecordingLink, WatchedState

from beatrix_zenoh.client import CameraImage, RobotState
from beatrix_zenoh.contract._generated.messages import Event, EventKind
from gui.console.state.actions import Outcome, Send
from gui.console.state.intents import Choose, Jog, Tab
from gui.console.state.world import World
from gui.window.window import Window

HOUR_S = 3600
ROUNDS = 500
"""Requests of this window in the hour."""
COUNTED = (60, 280, ROUNDS)
"""Round at which tracemalloc starts, and rounds at which memory is measured.

At the first measurement every list is full of rows that tracemalloc has counted.
"""
EVENTS = 70
"""Events kept of each robot; another seat causes one at every third request."""
JPEG: bytes = simplejpeg.encode_jpeg(np.zeros((48, 64, 3), np.uint8))
GUI = str(Path(__file__).resolve().parents[2] / "gui" / "*")


class Kept(msgspec.Struct, frozen=True):
    """What the window keeps at the end of the hour."""

    rows: int
    undo: int
    listed: int
    """rows in the list of the history"""
    bytes: list[int]
    """bytes that our modules have allocated and still use, at both measurements"""
    threads: list[int]
    """number of threads at the start and at the end"""


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
    """Return the number of bytes that modules of the window have allocated and still use."""
    gc.collect()  # by itself, the collector runs too seldom in a process with many objects
    snapshot = tracemalloc.take_snapshot().filter_traces(
        [tracemalloc.Filter(inclusive=True, filename_pattern=GUI)]
    )
    return sum(trace.size for trace in snapshot.traces)


def work(window: Window, link: RecordingLink, state: WatchedState) -> Kept:
    """Send ROUNDS requests, with events of other seats and pictures; return what is kept."""
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
        for side in sent.sides:
            window.report(Outcome(sent.row, side, accepted=True, done=True, duration_s=1.0))
        window.handle(Choose("tab", list(Tab)[number // 20 % len(Tab)]))
        for seq in range(3):
            window.show_image("sim", picture(3 * number + seq, passed_s))
        if number % 20 == 0:
            QTest.qWait(1)
        if number == COUNTED[0]:
            tracemalloc.start()
        elif number in COUNTED:
            found.append(held())
    memory, listed = state._memory, window.panels.history.list.count()
    return Kept(len(memory.rows), len(memory.undo), listed, found, [threads, threading.active_count()])


def main() -> None:
    """Open the window, work, and print what is kept."""
    app = QApplication([])
    link, state = RecordingLink(), WatchedState()
    window = Window(link, state)
    window.resize(1366, 768)
    window.show()
    QTest.qWaitForWindowExposed(window)
    print(json.dumps(msgspec.to_builtins(work(window, link, state))), flush=True)
    window.close()
    app.processEvents()


if __name__ == "__main__":
    main()
