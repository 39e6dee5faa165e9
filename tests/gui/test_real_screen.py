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
from present import present
from robots import START_S, Process, Stage, ready, until

from gui.console.state.intents import Theme
from gui.window.theme import style_of

MISSING = [program for program in ("Xvfb", "xdotool", "openbox") if shutil.which(program) is None]
pytestmark = [
    pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}"),
    pytest.mark.long("a real screen with a window manager"),
]


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    """An X screen in memory, with a window manager, whose frames take room."""
    words = ("-displayfd", "1", "-screen", "0", "1366x768x24", "-nolisten", "tcp")
    with subprocess.Popen(
        ["Xvfb", *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as server:
        number = f":{present(server.stdout).readline().strip()}"
        manager = ["openbox", "--sm-disable"]
        environment = {**os.environ, "DISPLAY": number}
        with subprocess.Popen(manager, env=environment, stderr=subprocess.DEVNULL) as frames:
            yield number
            frames.terminate()
        server.terminate()


def tool(*words: str) -> str:
    """Return the output of xdotool; empty if it fails."""
    done = subprocess.run(["xdotool", *words], capture_output=True, text=True, timeout=10, check=False)
    return done.stdout.strip()


def pixels() -> npt.NDArray[np.uint8]:
    """Return the screen as red, green and blue, shape (height, width, 3)."""
    return np.asarray(ImageGrab.grab(xdisplay=os.environ["DISPLAY"]))


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        made.simulation("bea")
        made.hardware("bea")
        yield made


@pytest.fixture
def window(stage: Stage, display: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Process]:
    """The window, shown and with the keyboard focus; it starts with opencv-python's plugin path, which breaks Qt."""
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.setenv("QT_QPA_PLATFORM", "xcb")
    monkeypatch.setenv("QT_QPA_PLATFORM_PLUGIN_PATH", str(tmp_path / "cv2/qt/plugins"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    words = ("gui", "--name", "bea", "--connect", stage.endpoint)
    process = Process("-m", "beatrix_zenoh.cli", *words, traced=False, folder=tmp_path)
    try:
        process.expect("ready window")
        until(lambda: bool(found()), "the window is on the screen", START_S)
        tool("windowfocus", "--sync", found())
        yield process
    finally:
        process.end(signal.SIGKILL)


def found() -> str:
    """Return the number of the window on the screen; empty if it is not visible."""
    return tool("search", "--onlyvisible", "--name", "^BEATRIX – bea$").partition("\n")[0]


def test_space_stops_both_robots(window: Process, stage: Stage) -> None:
    robots = [ready(stage.robot("bea", side, "eve")) for side in ("sim", "hw")]
    red = tuple(bytes.fromhex(style_of(Theme.DARK).stop.lstrip("#")))
    until(lambda: tuple(pixels()[-6, 20]) == red, "STOP is whole above the lower edge of the screen")
    assert len(np.unique(pixels().reshape(-1, 3), axis=0)) > 1000, "the head is drawn"
    for robot in robots:
        robot.look(yaw=150, speed=20, wait=False)
    until(lambda: all(robot.positions().velocity.long > 10 for robot in robots), "both move")
    tool("key", "space")
    until(lambda: not any(robot.status().moving for robot in robots), "both rest", 2.0)
    assert all(robot.positions().arms.long < 140 for robot in robots)
    assert window.end() == 0
