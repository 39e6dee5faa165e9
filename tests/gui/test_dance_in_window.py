"""A dance of five poses, made with the widgets, played on both robots, and saved as a program that repeats it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from gui_windows import Windowed, near
from PyQt5.QtCore import QPoint
from PyQt5.QtTest import QTest

from beatrix_zenoh import Robot
from gui.window.widgets.files import FilePanel

pytestmark = [
    pytest.mark.qt_log_ignore("This plugin does not support"),  # dialogs without a display
    pytest.mark.no_cover,  # `test_sequence.py` and `test_sequence_widget.py` cover the same code
]

PRESSES = [("all", 1), ("short", -1), ("middle", 1), ("long", -1), ("all", -1)]
"""An arm and the direction in which it is turned before each pose is added."""
PROGRAM_S = 60.0


def make_dance(user: Windowed) -> None:
    """Turn the simulation by buttons, add five poses, and drag the last card before the fourth."""
    panels = user.window.panels
    sequence, strip = panels.sequence, panels.sequence.strip
    user.send_to("sim")
    user.type_number(panels.arms.increment.box, 10)
    for count, (arm, sign) in enumerate(PRESSES, start=1):
        row = panels.arms.rows[arm]
        user.press(row.plus if sign > 0 else row.minus)
        user.until_last("done")
        user.press(sequence.add)
        user.until(lambda count=count: len(strip.cards) == count, "the pose is shown")  # type: ignore[misc]
    user.type_number(sequence.duration, 1.5)
    before = [card.name for card in strip.cards]
    user.drag(
        strip.viewport(),
        strip.card(4).center(),
        strip.card(3).center() - QPoint(strip.card(0).width() // 3, 0),
    )
    user.until_shown()
    assert [card.name for card in strip.cards] == [*before[:3], before[4], before[3]]


def save(user: Windowed, panel: FilePanel, file: Path) -> None:
    """Choose a file in the open dialog; wait until it is written."""
    assert panel.dialog is not None
    panel.dialog.fileSelected.emit(str(file))
    panel.dialog.close()
    user.until(file.exists, "the program is written")
    user.until_last("done")


def assert_program_passes(user: Windowed, file: Path, sim: Robot, goals: list[tuple[float, ...]]) -> None:
    """Run a program; assert that the simulation goes through all goals (deg) in their order."""
    environment = os.environ | {"BEATRIX_WHO": "ana"}
    program = subprocess.Popen([sys.executable, str(file)], env=environment, stderr=subprocess.PIPE)
    left = goals.copy()

    def ended() -> bool:
        """Note the pose that the robot has reached; return whether the program has ended."""
        if left and near(sim.positions().arms, left[0], by=0.5):
            left.pop(0)
        QTest.qWait(20)
        return program.poll() is not None

    try:
        user.until(ended, "the program ends", PROGRAM_S)
    finally:
        program.kill()
    _, error = program.communicate(timeout=5.0)
    assert program.returncode == 0, error.decode()
    assert left == []


@pytest.mark.long("a dance in real time")
def test_a_dance_is_made_played_and_saved_as_a_program(
    user: Windowed, sim: Robot, hw: Robot, tmp_path: Path
) -> None:
    sequence = user.window.panels.sequence
    user.window.panels.low_area.setCurrentWidget(sequence)
    make_dance(user)
    goals = [pose.arms for pose in user.state.saved.poses]
    assert [pose.duration_s for pose in user.state.saved.poses] == [1.0, 1.0, 1.0, 1.5, 1.0]
    assert hw.positions().arms == pytest.approx((0, 0, 0), abs=0.2), "only the simulation has moved"

    assert not sequence.hardware.isEnabled()
    began_s = time.monotonic()
    user.press(sequence.play)
    user.until(sequence.hardware.isEnabled, "the simulation has played it")
    assert time.monotonic() - began_s > 4.5
    user.until_at(sim, *goals[-1])
    assert hw.positions().arms == pytest.approx((0, 0, 0), abs=0.2), "the hardware has waited"
    user.press(sequence.hardware)
    user.until_last("done", "hardware")
    user.until_at(hw, *goals[-1])

    sequence.entries["save_program"].trigger()
    save(user, sequence, tmp_path / "dance.py")
    assert_program_passes(user, tmp_path / "dance.py", sim, list(goals))


def test_the_code_of_a_session_repeats_its_motions(user: Windowed, sim: Robot, tmp_path: Path) -> None:
    panels = user.window.panels
    user.send_to("sim")
    user.press(panels.arms.rows["all"].plus)
    user.until_last("done")
    user.press(panels.arms.rows["short"].plus)
    user.until_last("done")
    goal = sim.positions().commanded
    panels.side.setCurrentWidget(panels.code)
    file = tmp_path / "mine.py"
    user.press(panels.code.save)
    save(user, panels.code, file)
    sim.home()
    assert_program_passes(user, file, sim, [tuple(goal)])
