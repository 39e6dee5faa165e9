"""The cameras of the simulation: two eyes in the head, and a view from outside; drawn while a client subscribes.

Physics has priority. A separate process draws at low priority from a copy of the state, and less often if drawing would
take too much time or if physics steps are late.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.node import CameraFrame, CameraPublisher, Component, Node, StatusFields
from sim_node import gl
from sim_node.painter import SceneState
from sim_node.rays import RayPainter
from sim_node.renderer import HEIGHT, WIDTH, Renderer

SHARE: Final = 0.5
"""Largest share of the time for drawing; on two cores the rest is for physics and all other threads."""
SLOWEST_S: Final = 2.0
"""Longest time between two pictures, also on a busy computer."""
SLOWER: Final = 1.5
"""Factor for the period after a picture during which physics steps were late."""
FASTER: Final = 0.97
"""Factor for the period after a picture during which no physics step was late."""
MEMORY: Final = 0.8
"""Weight of the past in the mean time that a picture takes."""


class FrameRate:
    """Computes when to draw next; all times in seconds of one monotonic clock."""

    def __init__(self, requested_hz: float) -> None:
        self._requested_s = 1.0 / requested_hz
        self._due_s = float("-inf")
        self._cost_s = 0.0
        self._held_back = 1.0

    @property
    def period_s(self) -> float:
        """The present time between two pictures."""
        wanted = max(self._requested_s, self._cost_s / SHARE) * self._held_back
        return max(self._requested_s, min(wanted, SLOWEST_S))

    @property
    def slowed(self) -> bool:
        """Whether the rate is below the requested one."""
        return self.period_s > self._requested_s

    def wait_s(self, now_s: float) -> float:
        """Return the seconds until the next picture is due."""
        return max(0.0, self._due_s - now_s)

    def drawn(self, begin_s: float, end_s: float, *, late: bool) -> None:
        """Record how long a picture of each camera took to draw, and schedule the next.

        `late`: whether physics steps were late meanwhile.
        """
        cost_s = end_s - begin_s
        self._cost_s = MEMORY * self._cost_s + (1 - MEMORY) * cost_s if self._cost_s else cost_s
        self._held_back = self._held_back * SLOWER if late else max(1.0, self._held_back * FASTER)
        self._held_back = min(self._held_back, SLOWEST_S / self._requested_s)
        # Count from the deadline, so that the mean rate is the requested one. Missed pictures are not drawn later.
        missed = self._due_s + self.period_s < begin_s
        self._due_s = (begin_s if missed else self._due_s) + self.period_s

    def reset(self) -> None:
        """Reset after the last subscriber has gone: the next picture is due at once."""
        self._due_s, self._cost_s, self._held_back = float("-inf"), 0.0, 1.0


IDLE_S: Final = 10.0
"""Time after the last subscriber until the drawing process ends."""
RETRY_S: Final = 5.0
"""Time between two attempts to start the process for ray casting."""
COARSE: Final = (
    "This computer has no OpenGL for the simulated eyes: their pictures are coarse and slow. On Debian and Ubuntu: "
    "sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri; then restart the simulation."
)
UNSTEADY: Final = (
    "OpenGL has failed repeatedly: the pictures of the simulated eyes are coarse and slow until the simulation is "
    "restarted. MUJOCO_GL=egl or osmesa selects the driver."
)
OUTSIDE_EVERY: Final = 3
"""If the time does not suffice for all cameras, the outside view is drawn with every third picture of the eyes."""
NO_RENDERER: Final = (
    "The process that draws the pictures cannot be started, has crashed, or hangs; it is restarted."
)
GL_FAILURES: Final = 3
"""After this many failures of OpenGL in short succession the pictures are drawn by ray casting."""
SOON_S: Final = 60.0
"""Failures further apart than this are not counted together; a start that hangs fails sooner, and so is counted."""
_log = logging.getLogger(__name__)


class Eyes(Component):
    """Publishes the pictures of the cameras; a thread requests and receives them."""

    def __init__(
        self,
        node: Node,
        robot: RobotData,
        hz: float,
        scene_state: Callable[[], SceneState],
        late_steps: Callable[[], int],
    ) -> None:
        """Create the eyes; the drawing process starts with the first subscriber.

        Args:
            node: the node whose name the pictures have.
            robot: values of the robot that is drawn.
            hz: pictures a second of each camera, if this computer has the time.
            scene_state: returns the present scene.
            late_steps: returns the number of late physics steps so far.
        """
        self._robot, self._scene_state, self._late_steps = robot, scene_state, late_steps
        self._rate = FrameRate(hz)
        self._wake, self._closed = threading.Event(), threading.Event()
        self._publishers = {
            view: CameraPublisher(keys.camera(node.name, node.side, view), node.events, "", self._wake.set)
            for view in names.VIEWS
        }
        self._rounds = 0
        self._lock = threading.Lock()
        self._renderer: Renderer | None = None
        self._gl_failures, self._gl_failed_s = 0, float("-inf")
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        for publisher in self._publishers.values():
            publisher.start(sessions)
        self._report("")
        self._thread = threads.start(self._run, "eyes")

    def contribute(self, status: StatusFields) -> None:
        """Add both eyes and a warning about coarse pictures; the outside view is not a camera of the robot."""
        for eye in names.EYES:
            self._publishers[eye].contribute(status)
        views = [publisher.status() for publisher in self._publishers.values()]
        if any(view.streaming and view.source == RayPainter.source for view in views):
            status.warnings.append(UNSTEADY if self._gl_failures >= GL_FAILURES else COARSE)

    def _run(self) -> None:
        while not self._closed.is_set():
            self._wake.clear()
            subscribed = [view for view, publisher in self._publishers.items() if publisher.subscribed]
            if not subscribed:
                self._rate.reset()
                if not self._wake.wait(None if self._renderer is None else IDLE_S):
                    self._end_renderer()
            elif not self._closed.wait(self._rate.wait_s(time.monotonic())):
                self._draw(self._select(subscribed))
        self._end_renderer()

    def _select(self, subscribed: list[str]) -> list[str]:
        """Return the views to draw now: all, or only the eyes if the outside view would slow them."""
        self._rounds += 1
        if self._rate.slowed and self._rounds % OUTSIDE_EVERY:
            return [view for view in subscribed if view in names.EYES] or subscribed
        return subscribed

    def _draw(self, views: list[str]) -> None:
        """Draw and publish the present scene from these views."""
        try:
            renderer = self._renderer or self._start_renderer()
            begin_s, late_before = time.monotonic(), self._late_steps()
            state = self._scene_state()
            for view, jpeg in renderer.draw(state, views):
                frame = CameraFrame(jpeg, WIDTH, HEIGHT, state.t_mono_ns, renderer.source)
                self._publishers[view].publish(frame)
        except OSError as error:
            self._fail(error)
        else:
            self._report("")
            self._rate.drawn(begin_s, time.monotonic(), late=self._late_steps() > late_before)

    def _start_renderer(self) -> Renderer:
        """Start a drawing process; raises OSError if it cannot be started."""
        renderer = Renderer(self._robot, self._source())
        with self._lock:
            self._renderer = renderer
            if self._closed.is_set():  # `close` was called before this renderer was set
                renderer.close()
        renderer.open()
        return renderer

    def _source(self) -> str:
        """Return the method of drawing: OpenGL if it works, else ray casting."""
        steady = self._gl_failures < GL_FAILURES
        return (gl.backend() if steady else None) or RayPainter.source

    def _fail(self, error: OSError) -> None:
        """Close a drawing process that has failed or hangs, and report it.

        The next picture starts a new process. If that would use ray casting, wait for RETRY_S now.
        """
        self._end_renderer()
        if self._closed.is_set():
            return
        self._report(NO_RENDERER)
        if self._source() == RayPainter.source:
            self._closed.wait(RETRY_S)
        else:
            self._count_gl_failure(error)

    def _count_gl_failure(self, error: OSError) -> None:
        now_s = time.monotonic()
        soon = now_s - self._gl_failed_s < SOON_S
        self._gl_failures, self._gl_failed_s = self._gl_failures + 1 if soon else 1, now_s
        if self._gl_failures < GL_FAILURES:
            then = "the drawing process is restarted"
        else:
            then = (
                "OpenGL fails repeatedly, so pictures are drawn by ray casting from now on, coarse and slow"
            )
        _log.warning("Drawing with OpenGL has failed (%s): %s.", error, then)

    def _report(self, trouble: str) -> None:
        for eye in names.EYES:
            self._publishers[eye].report(trouble)

    def _end_renderer(self) -> None:
        with self._lock:
            if self._renderer is not None:
                self._renderer.close()
            self._renderer = None

    def close(self) -> None:
        """End the thread and the process, even if it hangs."""
        self._closed.set()
        self._wake.set()
        with self._lock:
            if self._renderer is not None:
                self._renderer.close()
        if self._thread is not None:
            self._thread.join(timeout=5.0)
