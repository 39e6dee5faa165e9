"""The cameras of the simulation: two eyes in the head, and a view from outside; drawn while a client subscribes.

Physics has priority. A separate process draws at low priority from a copy of the state, and less often if drawing would
take too much time or if physics steps are late. `Drawing` starts and ends this process, and closes it if it fails.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.node import Component, Node, SensorFrame, StatusFields, camera_publisher, picture
from sim_node import gl
from sim_node.painter import SceneState
from sim_node.renderer import HEIGHT, WIDTH, Renderer


class Drawing:
    """Draws for the robots of a process, one after the other, in a process that runs while any of them is watched.

    All robots have the same values, so that one scene serves all.
    """

    def __init__(self, robot: RobotData) -> None:
        """Store the values of the robots; the first picture starts the process."""
        self._robot = robot
        self._turn, self._lock = threading.Lock(), threading.Lock()
        self._users: set[object] = set()
        """The robots that are watched."""
        self._renderer: Renderer | None = None

    def draw(
        self,
        user: object,
        scene_state: Callable[[], SceneState],
        views: Sequence[str],
        publish: Callable[[str, SensorFrame], None],
    ) -> tuple[float, float]:
        """Draw the scene of a robot from these views when it is its turn, and publish each picture.

        Returns:
            When that began (s), and how long it took (s), times the number of robots that are watched.

        Raises:
            OSError: there is no OpenGL, or the process cannot be started, has ended or hangs; the next call starts another
                one.
        """
        with self._lock:
            self._users.add(user)
        with self._turn:
            try:
                renderer = self._renderer or self._open(user)
                begin_s, state = time.monotonic(), scene_state()
                for view, jpeg in renderer.draw(state, views):
                    publish(view, picture(jpeg, WIDTH, HEIGHT, state.t_mono_ns, renderer.source))
            except OSError:
                with self._lock:
                    self._close()
                raise
            return begin_s, (time.monotonic() - begin_s) * max(1, len(self._users))

    def end(self, user: object) -> None:
        """End the process, even if it hangs, unless another robot is watched; may be called twice."""
        with self._lock:
            self._users.discard(user)
            if not self._users:
                self._close()

    def _open(self, user: object) -> Renderer:
        backend = gl.backend()
        if backend is None:
            raise OSError("this computer has no OpenGL")
        renderer = Renderer(self._robot, backend)
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


SHARE: Final = 0.5
"""Largest share of the time for drawing; on two cores the rest is for physics and all other threads."""
SLOWEST_S: Final = 2.0
"""Longest time between two pictures, also on a busy computer."""
SLOWER: Final = 1.5
"""Factor for the period after a picture during which physics steps were late."""
FASTER: Final = 0.97
"""Factor for the period after a picture during which no physics step was late."""


class FrameRate:
    """Computes when to draw next; all times in seconds of one monotonic clock."""

    def __init__(self, requested_hz: float) -> None:
        self._requested_s = 1.0 / requested_hz
        self.reset()

    def reset(self) -> None:
        """Reset after the last subscriber has gone: the next picture is due at once."""
        self._due_s, self._held_back = float("-inf"), 1.0
        self.period_s = self._requested_s
        """the present time between two pictures"""

    def wait_s(self, now_s: float) -> float:
        """Return the seconds until the next picture is due."""
        return max(0.0, self._due_s - now_s)

    def drawn(self, begin_s: float, took_s: float, *, late: bool) -> None:
        """Record how long a picture of each camera of each robot took to draw, and schedule the next.

        `late`: whether physics steps were late meanwhile.
        """
        self._held_back = self._held_back * SLOWER if late else max(1.0, self._held_back * FASTER)
        self._held_back = min(self._held_back, SLOWEST_S / self._requested_s)
        wanted = max(self._requested_s, took_s / SHARE) * self._held_back
        self.period_s = max(self._requested_s, min(wanted, SLOWEST_S))
        # Count from the deadline, so that the mean rate is the requested one. Missed pictures are not drawn later.
        missed = self._due_s + self.period_s < begin_s
        self._due_s = (begin_s if missed else self._due_s) + self.period_s


IDLE_S: Final = 10.0
"""Time after the last subscriber until the drawing process ends."""
RETRY_S: Final = 1.0
"""Time until the process is started again."""
NO_OPENGL: Final = (
    "This computer has no OpenGL for the simulated eyes, which see nothing. On Debian and Ubuntu: "
    "sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri libopengl0; then restart the simulation. MUJOCO_GL=egl or "
    "osmesa selects the driver."
)
NO_RENDERER: Final = (
    "The process that draws the pictures cannot be started, has crashed, or hangs; it is restarted."
)


class Eyes(Component):
    """Publishes the pictures of the cameras; a thread requests and receives them."""

    def __init__(
        self,
        node: Node,
        drawing: Drawing,
        hz: float,
        scene_state: Callable[[], SceneState],
        late_steps: Callable[[], int],
    ) -> None:
        """Create the eyes; the drawing process starts with the first subscriber.

        Args:
            node: the node whose name the pictures have.
            drawing: draws the pictures of this robot, and perhaps of others.
            hz: pictures a second of each camera, if this computer has the time.
            scene_state: returns the present scene.
            late_steps: returns the number of late physics steps so far.
        """
        self._drawing, self._scene_state, self._late_steps = drawing, scene_state, late_steps
        self._rate = FrameRate(hz)
        self._wake, self._closed = threading.Event(), threading.Event()
        self._publishers = {
            view: camera_publisher(keys.camera(node.name, node.side, view), node.events, "", self._wake.set)
            for view in names.VIEWS
        }
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        for publisher in self._publishers.values():
            publisher.start(sessions)
        self._report("")
        self._thread = threads.start(self._run, "eyes")

    def contribute(self, status: StatusFields) -> None:
        """Add both eyes; the outside view is not a camera of the robot."""
        for eye in names.EYES:
            self._publishers[eye].contribute(status)

    def _run(self) -> None:
        watched = False
        while not self._closed.is_set():
            self._wake.clear()
            subscribed = [view for view, publisher in self._publishers.items() if publisher.subscribed]
            if not subscribed:
                self._rate.reset()
                if not self._wake.wait(IDLE_S if watched else None):
                    self._drawing.end(self)
                    watched = False
            elif not self._closed.wait(self._rate.wait_s(time.monotonic())):
                watched = True
                self._draw(subscribed)
        self._drawing.end(self)

    def _draw(self, views: list[str]) -> None:
        """Draw and publish the present scene from these views."""
        late_before = self._late_steps()
        try:
            begin_s, took_s = self._drawing.draw(
                self,
                self._scene_state,
                views,
                lambda view, frame: self._publishers[view].publish(frame),
            )
        except OSError:  # the next picture starts a new process
            if not self._closed.is_set():
                self._report(NO_OPENGL if gl.backend() is None else NO_RENDERER)
                self._closed.wait(RETRY_S)
        else:
            self._report("")
            self._rate.drawn(begin_s, took_s, late=self._late_steps() > late_before)

    def _report(self, trouble: str) -> None:
        for eye in names.EYES:
            self._publishers[eye].report(trouble)

    def close(self) -> None:
        """End the thread, and the process unless it draws for other robots."""
        self._closed.set()
        self._wake.set()
        self._drawing.end(self)
        if self._thread is not None:
            self._thread.join(timeout=5.0)
