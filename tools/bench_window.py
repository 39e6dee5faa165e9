"""Benchmark of the window: its start, latency of presses and STOP, CPU, pictures of head and cameras, memory."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

os.environ["QT_QPA_PLATFORM"] = "offscreen"

from bench_node import Served, free_endpoint, spread_ms
from PyQt5.QtCore import QEvent, QEventLoop, Qt
from PyQt5.QtGui import QKeyEvent
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QWidget

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.stopping import QueuedStop
from beatrix_zenoh.settings import Settings
from gui.console.state.actions import Outcome
from gui.console.state.intents import Choose, Tab
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.window.run import SIZE, linked_window, qt_application
from gui.window.widgets.eyes import CameraPicture
from gui.window.widgets.head3d import Head3d
from gui.window.window import Window

NAME: Final = "bench"
PRESSES: Final = 60
STOPS: Final = 30
IDLE_S: Final = 4.0
TURN_DEG, TURN_DEG_S = 90.0, 20.0
"""A motion that lasts longer than the head is watched."""
PATIENCE_S: Final = 10.0


class Times:
    """Times (monotonic clock, s) of sent requests and shown outcomes, and ages (s) of drawn pictures.

    Wrappers around methods of the window and the client record them.
    """

    def __init__(self, window: Window) -> None:
        self.sent: list[float] = []
        self.stopped: list[float] = []
        self.shown: list[tuple[float, Outcome]] = []
        self.ages_s: list[float] = []
        self.heads = 0
        """how often the head in three dimensions was drawn"""
        show, ask, stop, paint = window.report, Request.__init__, QueuedStop.send, CameraPicture.paintEvent

        def report(outcome: Outcome) -> None:
            show(outcome)
            self.shown.append((time.monotonic(), outcome))

        def request(made: Request, *args: object, **options: object) -> None:
            ask(made, *args, **options)  # type: ignore[arg-type]
            if args[2:3] and "/motion" in str(args[2]):
                self.sent.append(time.monotonic())

        def send_stop(queued: QueuedStop) -> None:
            stop(queued)
            self.stopped.append(time.monotonic())

        def draw(picture: CameraPicture, event: object) -> None:
            paint(picture, event)  # type: ignore[arg-type]
            newest = picture._newest  # noqa: SLF001
            if newest is not None:
                self.ages_s.append(time.monotonic() - newest.t_mono_ns / 1e9)

        draw_head = Head3d.paintEvent

        def draw_3d(head: Head3d, event: object) -> None:
            draw_head(head, event)  # type: ignore[arg-type]
            self.heads += 1

        Head3d.paintEvent = draw_3d  # type: ignore[assignment,method-assign]
        window.report = report  # type: ignore[method-assign]
        Request.__init__ = request  # type: ignore[assignment,method-assign]
        QueuedStop.send = send_stop  # type: ignore[assignment,method-assign]
        CameraPicture.paintEvent = draw  # type: ignore[assignment,method-assign]


def until(holds: Callable[[], object]) -> None:
    """Process events of the window until `holds` returns true."""
    deadline_s = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline_s, "no answer"
        QApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)


def presses(window: Window, times: Times) -> tuple[list[float], list[float]]:
    """Press + and - of all arms; return the times (s) until the query was sent, and until its acceptance was shown."""
    sent, shown = [], []
    row = window.panels.arms.rows["all"]
    for number in range(PRESSES):
        times.sent.clear()
        times.shown.clear()
        began_s = click(row.minus if number % 2 else row.plus)
        until(lambda: times.shown)
        assert times.shown[0][1].accepted, times.shown[0][1]
        shown.append(times.shown[0][0] - began_s)
        sent.append(times.sent[0] - began_s)
        until(lambda: any(outcome.done for _, outcome in times.shown))
        QTest.qWait(30 + number % 17)  # otherwise the phase of the timer would always be the same
    return sent, shown


def click(widget: QWidget) -> float:
    """Click a button with the mouse; return the time of the release (monotonic clock, s)."""
    QTest.mousePress(widget, Qt.MouseButton.LeftButton)
    began_s = time.monotonic()
    QTest.mouseRelease(widget, Qt.MouseButton.LeftButton)
    return began_s


def stops(window: Window, times: Times) -> tuple[list[float], list[float]]:
    """Press Space during motions; return the times (s) until STOP was sent, and until arms at rest were shown."""
    sent, shown = [], []
    window.handle(Choose("increment", 60.0))
    window.handle(Choose("speed", 30.0))
    row = window.panels.arms.rows["all"]
    for number in range(STOPS):
        times.shown.clear()
        click(row.minus if number % 2 else row.plus)
        until(lambda: times.shown)
        QTest.qWait(200)
        times.stopped.clear()
        times.shown.clear()
        space = QKeyEvent(QEvent.Type.KeyPress, Qt.Key.Key_Space, Qt.KeyboardModifier.NoModifier)
        began_s = time.monotonic()
        QApplication.sendEvent(window, space)
        until(
            lambda: any(
                outcome.side == "hw" and outcome.done and outcome.accepted for _, outcome in times.shown
            )
        )
        sent.append(times.stopped[0] - began_s)
        shown.append(
            next(at for at, outcome in times.shown if outcome.side == "hw" and outcome.accepted) - began_s
        )
        QTest.qWait(30 + number % 17)
    return sent, shown


def show(window: Window, tab: Tab) -> None:
    """Show a tab of the middle, and let it settle."""
    window.handle(Choose("tab", tab))
    window.panels.tabs.setCurrentIndex(list(Tab).index(tab))
    QTest.qWait(1500)


def cpu(window: Window, tab: Tab) -> float:
    """Return the share of a core that the window uses while a tab is shown."""
    show(window, tab)
    began_s, spent_s = time.monotonic(), time.process_time()
    QTest.qWait(round(1000 * IDLE_S))
    return (time.process_time() - spent_s) / (time.monotonic() - began_s)


def turning(window: Window, times: Times, robot: Robot) -> tuple[float, float]:
    """Return how often the head is drawn in a second of a motion, and the share of a core that the window uses."""
    show(window, Tab.HEADS)
    motion = robot.move(TURN_DEG, TURN_DEG, TURN_DEG, speed=TURN_DEG_S, wait=False)
    QTest.qWait(200)
    times.heads, began_s, spent_s = 0, time.monotonic(), time.process_time()
    QTest.qWait(round(500 * IDLE_S))
    took_s = time.monotonic() - began_s
    found = times.heads / took_s, (time.process_time() - spent_s) / took_s
    motion.cancel()
    robot.home()
    return found


def rss_mib() -> float:
    """Return the resident memory of this process (MiB)."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def start_s(endpoint: str) -> float:
    """Return the time (s) from the command to a window that can be used."""
    window = Served("beatrix_zenoh.cli", "gui", "--name", NAME, "--connect", endpoint, "--who", "other")
    window.end()
    return window.ready_s


def measure(window: Window, endpoint: str) -> None:
    """Print all measurements of a window in front of a hardware node with two cameras of 30 pictures a second."""
    times, began_mib, began_s = Times(window), rss_mib(), time.monotonic()
    with Robot(NAME, "hw", connect=endpoint, who="bench") as robot:
        robot.make_ready()
        drawn, moving = turning(window, times, robot)
    window.handle(Choose("sim", value=False))
    window.handle(Choose("hw", value=True))
    window.handle(Choose("cameras", value=True))
    until(lambda: "ms" in window.panels.header.pills["hw"].notes.text())
    plots = cpu(window, Tab.PLOTS)
    eyes = cpu(window, Tab.EYES)
    times.ages_s.clear()
    sent, shown = presses(window, times)
    show(window, Tab.HEADS)
    _, shown_3d = presses(window, times)
    show(window, Tab.EYES)
    stop_sent, stop_shown = stops(window, times)
    print("window with two cameras of 30 Hz, 640 x 480, drawn without a screen; median / p99 / largest [ms]")
    print(f"  press -> query sent: {spread_ms(sent)}")
    print(f"  press -> acceptance shown: {spread_ms(shown)} (required: median < 3, p99 < 15)")
    print(f"  the same beside the head in three dimensions: {spread_ms(shown_3d)} (required: the same)")
    print(f"  STOP key -> STOP sent: {spread_ms(stop_sent)} (required: < 2)")
    print(f"  STOP key -> arms at rest, shown (they brake from 30 deg/s): {spread_ms(stop_shown)}")
    print(f"  age of a picture when it is drawn: {spread_ms(times.ages_s)}")
    print(f"  CPU: {eyes:.0%} of a core with the pictures, {plots:.0%} with the plots")
    print(
        f"  head in three dimensions while its robot turns: {drawn:.0f} pictures/s, CPU {moving:.0%} (required: 15/s, < 40 %)"
    )
    print(
        f"  memory: {began_mib:.0f} MiB, {rss_mib():.0f} MiB after {time.monotonic() - began_s:.0f} s of presses and pictures"
    )


def main() -> None:
    """Run a router, a virtual robot whose cameras show the test picture, and a window, and measure the window."""
    endpoint = free_endpoint()
    router = Served("beatrix_zenoh.cli", "router", "--listen", endpoint)
    robot = Served("hw_node", "--name", NAME, "--connect", endpoint, "--port", "virtual:")
    application = qt_application()
    try:
        saved = Saved(increment=2.0, speed=80.0, lead_s=0.0)
        with linked_window(Settings(NAME, endpoint, "bench"), State(saved), name_given=True) as window:
            window.resize(*SIZE)
            window.show()
            measure(window, endpoint)
            window.close()
        print(f"  start of `beatrix gui` to a window that can be used: {start_s(endpoint):.2f} s")
    finally:
        robot.end()
        router.end()
    del application


if __name__ == "__main__":
    main()
