"""MuJoCo's viewer, in a subprocess because it needs the main thread and a display, and crashes when it ends."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

import numpy as np

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.node import Component
from sim_node.painter import SceneState
from sim_node.piped_process import PipedProcess

READY: Final = "ready"
"""Printed by the subprocess when the window is open."""
PERIOD_S: Final = 1 / 30


class Viewer:
    """A window that shows the scene until the user closes it."""

    def __init__(self, robot: RobotData) -> None:
        """Open the window; raises Refused if that fails, usually because there is no display."""
        self._process = PipedProcess("sim_node.viewer_process", robot)
        if self._process.first_line() != READY:
            self.close()
            raise Refused(
                Reason.BAD_VALUE,
                "--view: no window can be opened, because there is no display or the display has no OpenGL. Omit "
                "--view: the simulation and its eyes need no display.",
            )

    def show(self, state: SceneState) -> None:
        """Show a state; raises OSError if the window is closed. Blocks while the window hangs, until `close`."""
        self._process.write(np.concatenate((state.posture, state.target)).tobytes())

    def close(self) -> None:
        """Close the window; may be called twice."""
        self._process.close()


class ViewerFeed(Component):
    """Shows the simulation in a viewer, on its own thread, until the user closes the window."""

    def __init__(self, viewer: Viewer, scene_state: Callable[[], SceneState]) -> None:
        self._viewer, self._scene_state = viewer, scene_state
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        self._thread = threads.start(self._run, "viewer")

    def _run(self) -> None:
        while not self._closed.wait(PERIOD_S):
            try:
                self._viewer.show(self._scene_state())
            except OSError:
                return

    def close(self) -> None:
        """Close the window, and end the thread."""
        self._closed.set()
        self._viewer.close()
        if self._thread is not None:
            self._thread.join(timeout=5.0)
