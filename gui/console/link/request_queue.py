"""Requests to one robot, in a queue of their own, so that a silent robot does not delay the other one."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import accepted, done, failed, replaced, stopped
from gui.console.state.actions import Outcome

LIMIT = 8
"""Largest number of requests that may wait for a robot."""


@dataclass(frozen=True, eq=False)
class QueuedRequest:
    """A request in the queue."""

    row: int
    robot: Robot
    do: Callable[[Robot], str]
    """sends the request; returns the robot's message"""
    query: MotionQuery | PoseQuery | None = None
    """the motion, if it is one"""
    clear: Callable[[], None] = lambda: None
    """ends motions that must not run beside this motion; called before this motion is sent"""
    begun: Callable[[], None] = lambda: None
    """called when the motion was accepted"""


class RequestQueue:
    """Sends requests to one robot one after the other; a newer motion replaces one that still waits."""

    def __init__(self, side: str, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        self._side, self._jobs, self._report = side, jobs, report
        self._lock = threading.Lock()
        self._waiting: list[QueuedRequest] = []
        self._stops = 0
        self._running: tuple[Robot, Motion] | None = None
        """The motion that was begun last, until its end."""

    # -- any thread; none of these waits ------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether a motion runs, or a request waits."""
        return self._running is not None or bool(self._waiting)

    def move(
        self,
        row: int,
        robot: Robot,
        query: MotionQuery | PoseQuery,
        clear: Callable[[], None],
        begun: Callable[[], None],
    ) -> None:
        """Queue a motion, which replaces one that still waits."""
        self._put(QueuedRequest(row, robot, lambda _: "", query, clear, begun))

    def ask(self, row: int, robot: Robot, do: Callable[[Robot], str]) -> None:
        """Queue a request that is not a motion: `do` sends it and returns the robot's message."""
        self._put(QueuedRequest(row, robot, do))

    def stop(self) -> None:
        """Drop waiting requests; a motion that is being sent is stopped when the robot has accepted it."""
        with self._lock:
            self._stops += 1
            dropped, self._waiting = self._waiting, []
        for task in dropped:
            self._report(failed(task.row, self._side, stopped()))

    def release(self) -> None:
        """Drop waiting requests and stop the running motion, because later STOPs of the window go to another robot."""
        self.stop()
        if (running := self._running) is not None:
            robot, _ = running
            publish_stop(robot.client, robot.place)

    def replace(self) -> None:
        """Drop a waiting motion, which a newer motion or a play replaces."""
        with self._lock:
            dropped = [task for task in self._waiting if task.query is not None]
            self._waiting = [task for task in self._waiting if task.query is None]
        for task in dropped:
            self._report(failed(task.row, self._side, replaced()))

    def _put(self, task: QueuedRequest) -> None:
        if task.query is not None:
            self.replace()
        with self._lock:
            full = len(self._waiting) >= LIMIT
            if not full:
                self._waiting.append(task)
        if full:
            text = (
                f"{LIMIT} requests to {task.robot} are waiting, which is the limit. Wait, or check whether the robot "
                "responds."
            )
            self._report(failed(task.row, self._side, Refused(Reason.BUSY, text)))
        else:
            self._jobs.put(self._side, self._next)

    # -- one after the other -----------------------------------------------------------------------

    def _next(self) -> None:
        with self._lock:
            task = self._waiting.pop(0) if self._waiting else None
            stops = self._stops
        if task is None:
            return
        try:
            if task.query is None:
                self._report(done(task.row, self._side, task.do(task.robot)))
            else:
                self._begin(task, task.query, stops)
        except BeatrixError as error:
            self._report(failed(task.row, self._side, error))

    def _begin(self, task: QueuedRequest, query: MotionQuery | PoseQuery, stops: int) -> None:
        task.clear()
        began_s = time.monotonic()
        motion = task.robot.begin(query)
        self._running = task.robot, motion
        if self._stops != stops:  # the STOP sent meanwhile may have arrived before the motion
            publish_stop(task.robot.client, task.robot.place)
        task.begun()
        self._report(accepted(task.row, self._side, motion.accepted.message, motion.duration))

        def ended(motion: Motion) -> None:
            error = motion.exception(0.0)
            took_s = time.monotonic() - began_s
            if self._running == (task.robot, motion):
                self._running = None
            self._report(
                done(task.row, self._side, motion.result(0.0).message, took_s)
                if error is None
                else failed(task.row, self._side, error)
            )

        motion.add_done_callback(ended)

    def close(self) -> None:
        """Drop waiting requests without reports; returns at once."""
        with self._lock:
            self._stops += 1
            self._waiting.clear()
