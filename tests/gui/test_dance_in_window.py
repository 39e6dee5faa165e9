"""A dance of five poses, made with the widgets, played on both robots, and saved as a program that repeats it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from gui_windows import Windowed, near

from beatrix_zenoh import Robot
from gui.window.widgets.files import FilePanel

pytestmark = [
    pytest.mark.qt_log_ignore("This plugin does not support"),  # dialogs without a display
    pytest.mark.no_cover,  # `test_sequence.py` and `test_sequence_widget.py` cover the same code
]

"""An arm and the direction in which it is turned before each pose is added."""
PROGRAM_S = 60.0


def save(user: Windowed, panel: FilePanel, file: Path) -> None:
    """Choose a file in the open dialog; wait until it is written."""
    assert panel.dialog is not None
    panel.dialog.fileSelected.emit(str(file))
    panel.dialog.close()
    user.until(file.exists, "the program is written")
    user.until_last("done")


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
    environment = os.environ | {"BEATRIX_WHO": "ana"}
    done = subprocess.run(
        [sys.executable, str(file)], check=False, env=environment, timeout=PROGRAM_S, capture_output=True
    )
    assert done.returncode == 0, done.stderr.decode()
    assert near(sim.positions().arms, tuple(goal))
