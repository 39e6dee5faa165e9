"""What moves the robots of the shown name: queues of requests, motions of both, plays, and the program for faces.

A newer motion ends what it replaces, and begins when that has ended.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from beatrix_zenoh.client import lease
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.settings import Settings
from gui.console.link import outcomes
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError, done, failed, replaced
from gui.console.link.plans import Plans
from gui.console.link.programs import FaceProgram, Following, Playing, Programs
from gui.console.state import actions
from gui.console.state.actions import Outcome

Request = (
    actions.Send
    | actions.Play
    | actions.SendCommand
    | actions.AskLease
    | actions.MakeReady
    | actions.FollowFace
)
"""Actions that robots of the shown name answer."""


@dataclass(frozen=True, eq=False)
class QueuedRequest:
    """A request in the queue."""

    row: int
    robot: Robot
    do: Callable[[Robot], str] = lambda _: ""
    """sends the request, unless it is a motion; returns the robot's message"""
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

    def put(self, task: QueuedRequest) -> None:
        """Queue a request; a motion replaces one that still waits."""
        if task.query is not None:
            self.replace()
        with self._lock:
            self._waiting.append(task)
        self._jobs.put(self._side, self._next)

    def stop(self) -> None:
        """Drop waiting requests; a motion that is being sent is stopped when the robot has accepted it."""
        with self._lock:
            self._stops += 1
            dropped, self._waiting = self._waiting, []
        for task in dropped:
            self._report(failed(task.row, self._side, outcomes.stopped()))

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
        self._report(outcomes.accepted(task.row, self._side, motion.accepted.message, motion.duration))

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


class Moving:
    """Carries out requests for one robot or both; no method waits for a robot."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        """Store the arguments; `report` is called with the outcomes of requests."""
        self._report = report
        self._queues = {side: RequestQueue(side, jobs, report) for side in SIDES}
        self.plans, self.face = Plans(jobs, report), FaceProgram(jobs, report)
        self._programs = Programs(jobs, report, lambda: self.plans.drop_leading(replaced()))

    @property
    def busy(self) -> bool:
        """Whether robots move, or are about to move, for the link."""
        both = self._programs.newest is not None or self.plans.progress() is not None
        return both or any(queue.busy for queue in self._queues.values())

    @property
    def play(self) -> Playing | None:
        """The present play."""
        program = self._programs.newest
        return program if isinstance(program, Playing) else None

    @property
    def following(self) -> Following | None:
        """The present run of the program that follows a face."""
        program = self._programs.newest
        return program if isinstance(program, Following) else None

    def end_following(self) -> None:
        """End the program that follows a face, because the user wants it."""
        if (program := self.following) is not None:
            program.end(None)

    def request(self, action: Request, twin: Twin, settings: Settings) -> None:
        """Carry out an action; programs get the robot, the router and the seat of the settings."""
        sides = (action.side,) if isinstance(action, actions.MakeReady | actions.AskLease) else action.sides
        robots = robots_of(twin, sides)
        if not robots:
            self._report(failed(action.row, "", WindowError(Reason.BAD_VALUE, "off.unchecked")))
            return
        match action:
            case actions.Send():
                self._send(action, twin, robots)
            case actions.Play():
                self._clear(robots)
                self._programs.begin(Playing(action, twin if len(robots) > 1 else robots[0]))
            case actions.FollowFace():
                self._clear(robots)
                self._programs.begin(Following(action, settings, self.face))
            case actions.SendCommand(row=row, command=command, value=value):
                self._ask(row, robots, lambda robot: robot.command(command, value=value).message)
            case actions.AskLease(row=row, action=asked):
                self._ask(row, robots, lambda robot: lease.ask(robot, asked).message)
            case actions.MakeReady(row=row):
                self._ask(row, robots, _make_ready)

    def make_way(self) -> None:
        """End what must not run beside a motion that the face itself sends."""
        self._programs.end(replaced())
        self.plans.drop_trying(replaced())
        self.plans.drop_leading(replaced())
        for queue in self._queues.values():
            queue.replace()

    def drop(self) -> None:
        """Drop waiting requests, and end plans, plays and programs, because STOP was pressed."""
        self._end(outcomes.stopped())
        for queue in self._queues.values():
            queue.stop()

    def deselect(self) -> None:
        """End all motions, because the user selects another robot."""
        self._end(outcomes.deselected())
        for queue in self._queues.values():
            queue.release()

    def close(self) -> None:
        """End all motions and drop waiting requests, because the link closes."""
        self._end(outcomes.closed())
        for queue in self._queues.values():
            queue.close()

    def _end(self, why: BeatrixError) -> None:
        self.plans.drop(why)
        self._programs.end(why)

    def _send(self, action: actions.Send, twin: Twin, robots: tuple[Robot, ...]) -> None:
        self._programs.end(replaced())
        if len(robots) > 1:
            for queue in self._queues.values():
                queue.replace()
            self.plans.send(action.row, twin, action.query, action.lead_s, self._programs.wait_ended)
            return
        self.plans.drop_trying(replaced())
        for robot in robots:
            task = QueuedRequest(
                action.row,
                robot,
                query=action.query,
                clear=self._programs.wait_ended,
                begun=lambda: self.plans.drop_leading(replaced()),
            )
            self._queues[robot.side].put(task)

    def _ask(self, row: int, robots: tuple[Robot, ...], do: Callable[[Robot], str]) -> None:
        for robot in robots:
            self._queues[robot.side].put(QueuedRequest(row, robot, do))

    def _clear(self, robots: tuple[Robot, ...]) -> None:
        """End what a play or a program of these robots replaces."""
        for robot in robots:
            self._queues[robot.side].replace()
        self.plans.drop_trying(replaced())


def _make_ready(robot: Robot) -> str:
    robot.make_ready()
    return "Motors on, home declared."


def robots_of(twin: Twin, sides: tuple[str, ...]) -> tuple[Robot, ...]:
    """Return the robots of these sides, the simulation first."""
    return tuple(robot for robot in (twin.sim, twin.hw) if robot.side in sides)
