"""Fixtures: Qt without a display, and a window for each test with a link that only records."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator

os.environ["QT_QPA_PLATFORM"] = "offscreen"

import pytest
from gui_windows import HOME, Windowed, begin_again, close_dialogs, windowed
from pytestqt.qtbot import QtBot
from recording_link import RecordingLink, ShownState, WatchedState
from robots import Stage, ready, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.node.callers import LOOP_S, QUIET_S
from gui.console.state.intents import Intent
from gui.console.state.saved import Saved
from gui.window.window import Window


@pytest.fixture(scope="session", autouse=True)
def runtime_folder(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Create a runtime folder if there is none, as in containers: Qt would warn, and warnings are errors."""
    os.environ.setdefault("XDG_RUNTIME_DIR", str(tmp_path_factory.mktemp("runtime")))


@pytest.fixture
def link() -> RecordingLink:
    return RecordingLink()


@pytest.fixture
def state() -> WatchedState:
    return WatchedState()


@pytest.fixture(scope="session")
def built(qapp: object) -> Window:
    """The window of all tests of this process: to build one takes longer than most tests."""
    return Window(RecordingLink(), WatchedState())


@pytest.fixture
def window(
    qtbot: QtBot, built: Window, link: RecordingLink, state: WatchedState | ShownState
) -> Iterator[Window]:
    """The window, shown and active, with the link and the state of this test; all else as at its start."""
    begin_again(built, link, state)
    qtbot.waitUntil(built.isActiveWindow)
    yield built
    close_dialogs(built)
    built.close()


@pytest.fixture
def intents(window: Window, state: WatchedState | ShownState) -> Callable[[], list[Intent]]:
    """Return a function that returns the intents since its last call, at first those after this fixture."""

    def taken() -> list[Intent]:
        given = state.intents.copy()
        state.intents.clear()
        return given

    return taken


# -- a window connected to real robots ------------------------------------------------------------


FAST = Saved(speed=80.0, lead_s=0.0)


@pytest.fixture(scope="module")
def stage(bea: Stage) -> Iterator[Stage]:
    """Both robots `bea`."""
    yield bea
    bea.close_clients()


@pytest.fixture(scope="module")
def calibrated(stage: Stage) -> None:
    """Calibrate both robots where they are: the file before may have left them away from home."""
    for robot in (stage.robot("bea", side) for side in ("sim", "hw")):
        robot.stop()
        robot.disable()
        ready(robot)


@pytest.fixture
def robots(stage: Stage, calibrated: None) -> Iterator[dict[str, Robot]]:
    """Both robots, through new sessions of the window's seat, which need not pause after an earlier STOP of the seat."""
    yield {side: stage.robot("bea", side) for side in ("sim", "hw")}
    stage.close_clients()


@pytest.fixture
def sim(robots: dict[str, Robot]) -> Robot:
    return robots["sim"]


@pytest.fixture
def hw(robots: dict[str, Robot]) -> Robot:
    return robots["hw"]


@pytest.fixture
def user(stage: Stage, robots: dict[str, Robot], qtbot: QtBot) -> Iterator[Windowed]:
    """A window connected to two robots that are ready and at home; both are checked, without lead, at 80 deg/s."""
    for robot in robots.values():
        until(lambda robot=robot: is_at_rest(robot), "the arms rest, and a pause has ended")  # type: ignore[misc]
        robot.make_ready()
        if robot.positions().commanded != HOME:
            robot.move(*HOME, speed=80)
    with windowed(stage.endpoint, saved=FAST) as made:
        made.until_ready("sim", "hw")
        made.send_to("sim", "hw")
        yield made


def is_at_rest(robot: Robot) -> bool:
    """Return whether the arms rest, and the pause after a STOP of another seat has ended; one's own STOP prolongs it."""
    if robot.status().moving:
        return False  # the STOP of a window that closes may not be stored as an event yet
    stops = [event for event in robot.past_events() if event.kind == EventKind.STOP]
    other_ns = max((e.t_wall_ns for e in stops if e.seat != robot.client.settings.who), default=-math.inf)
    last_ns = max((e.t_wall_ns for e in stops if e.t_wall_ns - other_ns < LOOP_S * 1e9), default=0)
    return time.time_ns() - last_ns > QUIET_S * 1e9
