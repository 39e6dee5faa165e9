"""One request to robots of the shown name, from the press to its last outcome."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.client.twin import Plan, Twin
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from gui.console.link.outcomes import accepted
from gui.console.state.actions import Outcome
from gui.console.state.world import PlanPhase, PlanProgress

BOTH = ""
"""`Outcome.side` of a request to both robots."""
REST_S: Final = 5.0
"""How long a motion is previewed again because a robot still moves: a preview is valid only from where it began."""
AGAIN_S: Final = 0.05
"""Time between two previews of a motion."""
Report = Callable[[Outcome], None]


class RobotRequest(ABC):
    """One request; any thread may end it."""

    moves = True
    """whether it moves robots"""
    block = ""
    """id of the present block of a program of blocks"""

    def __init__(self, row: int, queue: str, sides: tuple[str, ...], side: str) -> None:
        """Store the arguments.

        Args:
            row: row of the outcomes.
            queue: the requests of a queue are performed one after the other.
            sides: the robots.
            side: side of the outcomes.
        """
        self.row, self.queue, self.sides, self.side = row, queue, sides, side
        self.running = False
        """whether it is too late to drop it: robots may move for it"""
        self.ends = False
        """whether it must end"""
        self.ending: BeatrixError | None = None
        """why it must end; None: it may go on, or the user has ended it"""
        self.over = threading.Event()
        """set at the end"""

    @property
    def leading(self) -> bool:
        """Whether the simulation moves already, and the hardware not yet."""
        return False

    @abstractmethod
    def perform(self, report: Report) -> str | Motion | TwinMotion:
        """Send the request; return the message of its end, or the motion that it has begun.

        Raises:
            BeatrixError: it was refused, or has failed.
        """

    def end(self, why: BeatrixError | None) -> None:
        """End it for a reason, unless it must end already; None: the user has ended it. Returns at once."""
        if not self.ends:
            self.ending, self.ends = why, True


class Question(RobotRequest):
    """A command or a lease query."""

    moves = False

    def __init__(self, row: int, robot: Robot, ask: Callable[[Robot], str]) -> None:
        """Store the arguments; `ask` sends the request, and returns the robot's message."""
        super().__init__(row, robot.side, (robot.side,), robot.side)
        self._robot, self._ask = robot, ask

    def perform(self, report: Report) -> str:  # noqa: ARG002
        """Send the request."""
        self.running = True
        return self._ask(self._robot)


class OneMotion(RobotRequest):
    """A motion of one robot."""

    def __init__(self, row: int, robot: Robot, query: MotionQuery | PoseQuery) -> None:
        """Store the arguments."""
        super().__init__(row, robot.side, (robot.side,), robot.side)
        self._robot, self._query = robot, query

    def perform(self, report: Report) -> Motion:
        """Begin the motion."""
        self.running = True
        motion = self._robot.begin(self._query)
        if self.ends:  # the STOP sent meanwhile may have arrived before the motion
            self.halt()
        report(accepted(self.row, self.side, motion.accepted.message, motion.duration))
        return motion

    def halt(self) -> None:
        """Send STOP to the robot."""
        if self.running:
            publish_stop(self._robot.client, self._robot.place)


class TwinMotionRequest(RobotRequest):
    """A motion of both robots: previewed, made by the simulation, and after the lead sent to the hardware."""

    def __init__(self, row: int, twin: Twin, query: MotionQuery | PoseQuery, lead_s: float) -> None:
        """Store the arguments."""
        super().__init__(row, "plans", ("sim", "hw"), BOTH)
        self._twin, self._query, self._lead_s = twin, query, lead_s
        self._plan: Plan | None = None

    @property
    def motion(self) -> TwinMotion | None:
        """The motion, after the plan was committed."""
        return None if self._plan is None else self._plan.motion

    @property
    def leading(self) -> bool:
        """Whether the simulation moves already, and the hardware not yet."""
        return self.running and self.motion is not None and not self.motion.hardware_sent

    def progress(self) -> PlanProgress:
        """Return how far it is."""
        plan, motion, lead_s = self._plan, self.motion, self._lead_s
        if plan is None:
            return PlanProgress(PlanPhase.TRYING, lead_s=lead_s)
        phase, countdown_s = PlanPhase.TRYING, lead_s
        if self.running and motion is not None:
            phase = PlanPhase.SENT if motion.hardware_sent else PlanPhase.LEADING
            countdown_s = motion.countdown_s
        return PlanProgress(phase, plan.duration, lead_s, countdown_s, plan.path, plan.apart, plan.alike)

    def perform(self, report: Report) -> str | TwinMotion:
        """Preview the motion and commit it, again while a robot still moves."""
        patient_until_s = time.monotonic() + REST_S
        while not self.ends:
            plan = self._plan = self._twin.preview_query(self._query)
            if self.ends:
                break
            try:
                motion = plan.commit(self._lead_s, wait=False)
            except Refused as error:
                if error.reason is not Reason.REPLACED or time.monotonic() > patient_until_s:
                    raise
                time.sleep(AGAIN_S)
                continue
            self.running = True
            if self.ends:
                self.halt()
            report(accepted(self.row, self.side, plan.verdict, plan.duration + self._lead_s))
            return motion
        return ""  # it was dropped, and its outcome reported

    def end(self, why: BeatrixError | None) -> None:
        """End the motion without waiting: nothing more is sent, and moving robots are stopped."""
        super().end(why)
        self.halt()

    def halt(self) -> None:
        """Stop the motion, and keep it from being sent to the hardware."""
        motion = self.motion
        if motion is not None and self.ending is not None:
            motion.end(self.ending)


class Program(RobotRequest):
    """What moves robots until it ends or must end; its thread looks whether it must."""

    def __init__(self, row: int, sides: tuple[str, ...], side: str) -> None:
        """Store row and robots."""
        super().__init__(row, "programs", sides, side)

    def perform(self, report: Report) -> str:
        """Do the work until the end."""
        self.running = True
        self.check()
        return self.run(report)

    @abstractmethod
    def run(self, report: Report) -> str:
        """Report the beginning, do the work until the end, and return the message; ends soon after `ends` is set."""

    def check(self) -> None:
        """Raise `ending` if there is one."""
        if self.ending is not None:
            raise self.ending
