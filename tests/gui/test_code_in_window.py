"""The program so far, run as it is: it repeats the motions of a session on the robots."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from gui_windows import Windowed, near

from beatrix_zenoh import Robot

PROGRAM_S = 60.0


@pytest.mark.no_cover
def test_the_code_of_a_session_repeats_its_motions(user: Windowed, sim: Robot) -> None:
    user.send_to("sim")
    for arm in ("all", "short"):
        user.press(user.window.panels.arms.rows[arm].plus)
        user.until_last("done")
    goal = sim.positions().commanded
    sim.home()
    program = user.state.view(user.window._world).code
    environment = os.environ | {"BEATRIX_WHO": "ana"}
    subprocess.run([sys.executable, "-c", program], check=True, env=environment, timeout=PROGRAM_S)
    assert near(sim.positions().arms, tuple(goal))
