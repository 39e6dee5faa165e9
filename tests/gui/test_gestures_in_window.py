"""Following a face in a window with both robots: what is pressed, and how the heads move."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_windows import Windowed

from beatrix_zenoh import Robot

pytestmark = [
    pytest.mark.qt_log_ignore("This plugin does not support"),
    pytest.mark.no_cover,  # the tests of state, link and widget cover the same code
]
SEEN_S = 60.0
"""Time limit (s) of the first pictures and of the start of a program on a busy computer."""


@pytest.fixture(autouse=True)
def home_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder without programs of the user."""
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path


@pytest.mark.long("follows with its eyes in real time")
def test_the_simulated_head_follows_a_person_who_walks_until_the_second_press(
    user: Windowed, sim: Robot, hw: Robot
) -> None:
    panel = user.window.panels.gestures
    user.send_to("sim")
    for end in (panel.follow, user.window.panels.stop_bar):
        sim.move_target(1.0, 0.5, 0.1)
        user.press(panel.follow)
        user.until(lambda: sim.positions().head.yaw > 20, "the head has turned to the left", SEEN_S)
        assert panel.follow.property("running") == "yes"
        sim.move_target(1.0, -0.5, 0.1)
        user.until(lambda: sim.positions().head.yaw < -20, "the head has turned to the right", SEEN_S)
        user.press(end)
        user.until(lambda: panel.follow.property("running") != "yes", "the program has ended")
        user.until(lambda: not sim.status().moving, "the head rests")
    assert hw.positions().head == pytest.approx((0, 0, 0), abs=0.5), "the hardware was not checked"
