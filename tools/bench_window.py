"""Benchmark of the window: latency of presses and STOP, CPU, and age of pictures."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
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
from gui.console.state.intents import SetCameras, SetDestination, SetIncrement, SetSpeed, ShowTab, Tab
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.window.run import SIZE, linked_window, qt_application
from gui.window.widgets.eyes import CameraPicture
from gui.window.window import Window

NAME: Final = "bench"
PRESSES: Final = 60
STOPS: Final = 30
IDLE_S: Final = 4.0
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
    window.handle(SetIncrement(60.0))
    window.handle(SetSpeed(30.0))
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


def cpu(window: Window, tab: Tab) -> float:
    """Return the share of a core that the window uses while a tab is shown."""
    window.handle(ShowTab(tab))
    window.panels.tabs.setCurrentIndex(list(Tab).index(tab))
    QTest.qWait(1500)
    began_s, spent_s = time.monotonic(), time.process_time()
    QTest.qWait(round(1000 * IDLE_S))
    return (time.process_time() - spent_s) / (time.monotonic() - began_s)


def measure(window: Window, endpoint: str) -> None:
    """Print all measurements of a window in front of a hardware node with two cameras of 30 pictures a second."""
    times = Times(window)
    with Robot(NAME, "hw", connect=endpoint) as robot:
        robot.make_ready()
    window.handle(SetDestination("sim", checked=False))
    window.handle(SetDestination("hw", checked=True))
    window.handle(SetCameras(on=True))
    until(lambda: "ms" in window.panels.header.pills["hw"].notes.text())
    plots = cpu(window, Tab.PLOTS)
    eyes = cpu(window, Tab.EYES)
    times.ages_s.clear()
    sent, shown = presses(window, times)
    stop_sent, stop_shown = stops(window, times)
    print("window with two cameras of 30 Hz, 640 x 480, drawn without a screen; median / p99 / largest [ms]")
    print(f"  press -> query sent: {spread_ms(sent)}")
    print(f"  press -> acceptance shown: {spread_ms(shown)} (required: median < 3, p99 < 15)")
    print(f"  STOP key -> STOP sent: {spread_ms(stop_sent)} (required: < 2)")
    print(f"  STOP key -> arms at rest, shown (they brake from 30 deg/s): {spread_ms(stop_shown)}")
    print(f"  age of a picture when it is drawn: {spread_ms(times.ages_s)}")
    print(f"  CPU: {eyes:.0%} of a core with the pictures, {plots:.0%} with the plots")


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
    finally:
        robot.end()
        router.end()
    del application


if __name__ == "__main__":
    main()
