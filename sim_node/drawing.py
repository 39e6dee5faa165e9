"""The process that draws the pictures of one simulation or several: its start, its failures, its end."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.node import CameraFrame
from sim_node import gl
from sim_node.painter import SceneState
from sim_node.rays import RayPainter
from sim_node.renderer import HEIGHT, WIDTH, Renderer

GL_FAILURES: Final = 3
"""After this many failures of OpenGL in short succession the pictures are drawn by ray casting."""
SOON_S: Final = 60.0
"""Failures further apart than this are not counted together; a start that hangs fails sooner, and so is counted."""
ACTIVE_S: Final = 3.0
"""Time (s) after a picture in which its robot counts as drawn; longer than the longest time between two pictures."""
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Drawn:
    """When a picture of each view was drawn."""

    begin_s: float
    end_s: float
    robots: int
    """number of robots that are drawn at present"""


class Drawing:
    """Draws for the robots of a process, one after the other, in a process that runs while any of them is watched.

    All robots have the same values, so that one scene serves all.
    """

    def __init__(self, robot: RobotData) -> None:
        """Store the values of the robots; the first picture starts the process."""
        self._robot = robot
        self._turn, self._lock = threading.Lock(), threading.Lock()
        self._users: dict[object, float] = {}
        """The robots that are watched, each with the time of its last picture (s)."""
        self._renderer: Renderer | None = None
        self._gl_failures, self._gl_failed_s = 0, float("-inf")

    @property
    def steady(self) -> bool:
        """Whether OpenGL has not failed repeatedly."""
        return self._gl_failures < GL_FAILURES

    @property
    def source(self) -> str:
        """The method of drawing: OpenGL if it works, else ray casting."""
        return (gl.backend() if self.steady else None) or RayPainter.source

    def draw(
        self,
        user: object,
        scene_state: Callable[[], SceneState],
        views: Sequence[str],
        publish: Callable[[str, CameraFrame], None],
    ) -> Drawn:
        """Draw the scene of a robot from these views when it is its turn, and publish each picture.

        Raises:
            OSError: the process cannot be started, has ended or hangs; the next call starts another one.
        """
        with self._turn:
            try:
                renderer = self._renderer or self._start(user)
                begin_s, state = time.monotonic(), scene_state()
                for view, jpeg in renderer.draw(state, views):
                    publish(view, CameraFrame(jpeg, WIDTH, HEIGHT, state.t_mono_ns, renderer.source))
            except OSError as error:
                self._fail(user, error)
                raise
            return Drawn(begin_s, time.monotonic(), self._drawn_robots(user))

    def _drawn_robots(self, user: object) -> int:
        now_s = time.monotonic()
        with self._lock:
            if user in self._users:
                self._users[user] = now_s
            return max(1, sum(now_s - drawn_s < ACTIVE_S for drawn_s in self._users.values()))

    def begin(self, user: object) -> None:
        """Keep the process for a robot that is watched."""
        with self._lock:
            self._users.setdefault(user, float("-inf"))

    def end(self, user: object) -> None:
        """End the process, even if it hangs, unless another robot is watched; may be called twice."""
        with self._lock:
            self._users.pop(user, None)
            if not self._users:
                self._close()

    def _start(self, user: object) -> Renderer:
        renderer = Renderer(self._robot, self.source)
        with self._lock:
            self._renderer = renderer
            if user not in self._users:  # `end` was called before this renderer was set
                renderer.close()
        renderer.open()
        return renderer

    def _close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
        self._renderer = None

    def _fail(self, user: object, error: OSError) -> None:
        """Close a process that has failed or hangs, and count the failures of OpenGL."""
        with self._lock:
            self._close()
            if user not in self._users:
                return
        if self.source == RayPainter.source:
            return
        now_s = time.monotonic()
        soon = now_s - self._gl_failed_s < SOON_S
        self._gl_failures, self._gl_failed_s = self._gl_failures + 1 if soon else 1, now_s
        if self.steady:
            then = "the drawing process is restarted"
        else:
            then = (
                "OpenGL fails repeatedly, so pictures are drawn by ray casting from now on, coarse and slow"
            )
        _log.warning("Drawing with OpenGL has failed (%s): %s.", error, then)
