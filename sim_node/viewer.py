"""MuJoCo's viewer with the mechanism inside the robot, hidden at first.

It runs in a subprocess because it needs the main thread and a display, and crashes when it ends.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from typing import Final

import mujoco

from beatrix_zenoh import threads
from beatrix_zenoh.body.figure import Figure, mechanism
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.node import Component
from sim_node.model import scene_spec
from sim_node.painter import PosedModel, SceneState
from sim_node.piped_process import READY, PipedProcess, begin, reply, requests
from sim_node.visuals import COLLISION, MATERIALS, add_meshes

MECHANISM: Final = 4
"""Geom group of the mechanism; MuJoCo's viewer shows and hides a group with the key of its number."""
SKIN_OPACITY: Final = 0.22
"""Opacity of the robot around the mechanism."""
KEYS: Final = (
    f"In the window, key {MECHANISM} shows the mechanism inside the robot, key {COLLISION} the simple shapes with mass "
    "that can touch each other."
)
PERIOD_S: Final = 1 / 30


class SceneViewer(Component):
    """A window that shows the scene of one simulation until the user closes it; a thread sends the states."""

    def __init__(self, robot: RobotData) -> None:
        """Open the window; raises Refused if that fails, usually because there is no display."""
        self._process = PipedProcess("sim_node.viewer", robot)
        try:
            self._process.open()
        except OSError as error:
            raise bad_value(
                "--view: no window can be opened, because there is no display or the display has no OpenGL. Omit "
                "--view: the simulation and its eyes need no display.",
            ) from error
        self.scene_state: Callable[[], SceneState] | None = None
        """returns the scene; the simulation sets it before `start`"""
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._thread = threads.start(self._run, "viewer")

    def _run(self) -> None:
        while self.scene_state is not None and not self._closed.wait(PERIOD_S):
            try:
                self._process.ask((), self.scene_state())
                self._process.read()  # a slow window gets fewer states, and never an old one
            except OSError:  # the user has closed the window
                return

    def close(self) -> None:
        """Close the window, and end the thread."""
        self._closed.set()
        self._process.close()
        if self._thread is not None:
            self._thread.join(timeout=5.0)


_CAMERA: Final = ((0.12, 0.0, -0.04), 1.5, 142.0, -16.0)
"""Point that the camera looks at (m), its distance from that point (m), azimuth and elevation (deg)."""


def add_mechanism(spec: mujoco.MjSpec, robot: RobotData = ROBOT) -> None:
    """Add the mechanism to a model of this robot, in a group that is hidden at first."""
    add_meshes(spec, mechanism(Figure(robot.geometry, robot.head), fine=True), MECHANISM)


def show_through(model: mujoco.MjModel, *, through: bool) -> None:
    """Make the robot translucent, so that its mechanism is seen, or opaque again."""
    for name in MATERIALS.values():
        model.material(name).rgba[3] = SKIN_OPACITY if through else 1.0


def main(words: list[str]) -> int:
    """Show the window until it is closed or the input ends; return the exit code."""
    robot = begin(words)
    os.environ.setdefault("LP_NUM_THREADS", "1")  # Mesa's software driver would use all cores
    import glfw  # noqa: PLC0415 - loads the display's libraries
    import mujoco.viewer  # noqa: PLC0415 - as above

    if not glfw.init():
        return 1
    spec = scene_spec(robot)
    add_mechanism(spec, robot)
    posed = PosedModel(spec.compile())
    with mujoco.viewer.launch_passive(
        posed.model, posed.data, show_left_ui=False, show_right_ui=False
    ) as viewer:
        viewer.cam.lookat, viewer.cam.distance, viewer.cam.azimuth, viewer.cam.elevation = _CAMERA
        reply(READY)
        for _, state in requests():
            with viewer.lock():
                show_through(posed.model, through=bool(viewer.opt.geomgroup[MECHANISM]))
                posed.pose(state.posture, state.target)
            viewer.sync()
            if not viewer.is_running():
                break
            reply(READY)
    return 0


if __name__ == "__main__":
    # Skip the shutdown of the interpreter, during which the threads of the viewer would crash.
    os._exit(main(sys.argv[1:]))
