"""The window as a process on a real X screen: its keys, and its picture."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from PIL import ImageGrab
from robots import START_S, Process, Stage, ready, until

from beatrix_zenoh import Robot
from gui.console.state.intents import Theme
from gui.window.theme import style_of

MISSING = [program for program in ("Xvfb", "xdotool", "openbox") if shutil.which(program) is None]
pytestmark = [
    pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}"),
    pytest.mark.long("a real screen with a window manager"),
]
END_S = 5.0
BOTH = {("bea", "sim"), ("bea", "hw")}


class Screen:
    """An X screen in memory, with a window manager, whose frames take room."""

    def __init__(self) -> None:
        words = ("-displayfd", "1", "-screen", "0", "1366x768x24", "-nolisten", "tcp")
        self._server = subprocess.Popen(
            ["Xvfb", *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self._server.stdout is not None
        self.display = f":{self._server.stdout.readline().strip()}"
        self._manager = subprocess.Popen(
            ["openbox", "--sm-disable"],
            env={**os.environ, "DISPLAY": self.display},
            stderr=subprocess.DEVNULL,
        )

    def tool(self, *words: str) -> str:
        """Return the output of xdotool; empty if it fails."""
        done = subprocess.run(
            ["xdotool", *words],
            env={**os.environ, "DISPLAY": self.display},
            capture_output=True,
            text=True,
            timeout=10,
            check=False,
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    def pixels(self) -> npt.NDArray[np.uint8]:
        """Return the screen as red, green and blue, shape (height, width, 3)."""
        return np.asarray(ImageGrab.grab(xdisplay=self.display))

    def close(self) -> None:
        self._manager.terminate()
        self._manager.wait(10)
        self._server.terminate()
        self._server.wait(10)
        if self._server.stdout is not None:
            self._server.stdout.close()


@pytest.fixture(scope="module")
def screen() -> Iterator[Screen]:
    made = Screen()
    yield made
    made.close()


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.simulation("bea")
        made.hardware("bea")
        yield made


@pytest.fixture
def window(
    stage: Stage, screen: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Process]:
    """The window, shown and with the keyboard focus; it starts with opencv-python's plugin path, which breaks Qt."""
    monkeypatch.setenv("DISPLAY", screen.display)
    monkeypatch.setenv("QT_QPA_PLATFORM", "xcb")
    monkeypatch.setenv("QT_QPA_PLATFORM_PLUGIN_PATH", str(tmp_path / "cv2/qt/plugins"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    words = ("gui", "--name", "bea", "--connect", stage.endpoint)
    process = Process("-m", "beatrix_zenoh.cli", *words, traced=False, folder=tmp_path)
    try:
        process.expect("ready window")
        until(lambda: bool(found(screen)), "the window is on the screen", START_S)
        screen.tool("windowfocus", "--sync", found(screen))
        yield process
    finally:
        process.end(signal.SIGKILL)


def found(screen: Screen) -> str:
    """Return the number of the window on the screen; empty if it is not visible."""
    return screen.tool("search", "--onlyvisible", "--name", "^BEATRIX – bea$").partition("\n")[0]


@pytest.fixture
def robots(stage: Stage) -> list[Robot]:
    return [ready(stage.robot("bea", side, "eve")) for side in ("sim", "hw")]


def test_space_stops_both_robots(window: Process, screen: Screen, robots: list[Robot]) -> None:
    red = tuple(bytes.fromhex(style_of(Theme.DARK).stop.lstrip("#")))
    until(lambda: tuple(screen.pixels()[-6, 20]) == red, "STOP is whole above the lower edge of the screen")
    assert len(np.unique(screen.pixels().reshape(-1, 3), axis=0)) > 1000, "the head is drawn"
    for robot in robots:
        robot.look(yaw=150, speed=20, wait=False)
    until(lambda: all(robot.positions().velocity.long > 10 for robot in robots), "both move")
    screen.tool("key", "space")
    until(lambda: not any(robot.status().moving for robot in robots), "both rest", 2.0)
    assert all(robot.positions().arms.long < 140 for robot in robots)
    assert window.end() == 0
