"""The process of the viewer: `python -m sim_node.viewer_process ROBOT`.

It reads states from standard input: the robot's posture and the person's place, as numbers of 8 bytes. It ends when the
user closes the window, or when its input ends.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from typing import Final

import msgspec
import numpy as np

from beatrix_zenoh.contract._generated.robot import RobotData
from sim_node.mechanism import MECHANISM, add_mechanism, show_through
from sim_node.painter import PosedModel
from sim_node.piped_process import NICE
from sim_node.scene import scene_spec
from sim_node.shapes import Vector

PERIOD_S: Final = 1 / 30
STDIN: Final = 0
STDOUT: Final = 1
_CAMERA: Final = ((0.12, 0.0, -0.04), 1.5, 142.0, -16.0)
"""Point that the camera looks at (m), its distance from that point (m), azimuth and elevation (deg)."""


class StateReader:
    """Reads states and keeps the newest."""

    def __init__(self, length: int) -> None:
        """Start reading states of `length` numbers."""
        self._bytes = 8 * length
        self.newest: Vector | None = None
        self.ended = False
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self) -> None:
        with os.fdopen(STDIN, "rb") as stream:
            while len(state := stream.read(self._bytes)) == self._bytes:
                self.newest = np.frombuffer(state)
        self.ended = True


def main(words: list[str]) -> int:
    """Show the window until it is closed or the input ends; return the exit code."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the simulation handles Ctrl-C and ends this process
    with contextlib.suppress(AttributeError, OSError):
        os.nice(NICE)
    os.environ.setdefault("LP_NUM_THREADS", "1")  # Mesa's software driver would use all cores
    import glfw  # noqa: PLC0415 - loads the display's libraries
    import mujoco.viewer  # noqa: PLC0415 - as above

    if not glfw.init():
        return 1
    robot = msgspec.json.decode(words[0], type=RobotData)
    spec = scene_spec(robot)
    add_mechanism(spec, robot)
    posed = PosedModel(spec.compile())
    states = StateReader(posed.model.nq + 3)
    with mujoco.viewer.launch_passive(
        posed.model, posed.data, show_left_ui=False, show_right_ui=False
    ) as viewer:
        viewer.cam.lookat, viewer.cam.distance, viewer.cam.azimuth, viewer.cam.elevation = _CAMERA
        os.write(STDOUT, b"ready\n")
        while viewer.is_running() and not states.ended:
            state = states.newest
            with viewer.lock():
                show_through(posed.model, through=bool(viewer.opt.geomgroup[MECHANISM]))
                if state is not None:
                    posed.pose(state[:-3], (float(state[-3]), float(state[-2]), float(state[-1])))
            viewer.sync()
            time.sleep(PERIOD_S)
    return 0


if __name__ == "__main__":
    # Skip the shutdown of the interpreter, during which the threads of the viewer would crash.
    os._exit(main(sys.argv[1:]))
