"""Programs of blocks: each motion is a request of its own, to one robot or to both."""

from __future__ import annotations

import contextlib
import threading
import time
from pathlib import Path
from typing import Final

from beatrix_zenoh.blocks.program import AXES, WrongProgram, read
from beatrix_zenoh.blocks.walker import Walker
from beatrix_zenoh.client.degrees import motion_query, pose_query
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import stopped
from beatrix_zenoh.client.twin_state import check_seat
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery
from beatrix_zenoh.contract.errors import BeatrixError
from gui.console.link.choreographies import Playing
from gui.console.link.outcomes import WindowError, accepted
from gui.console.link.request import BOTH, OneMotion, Program, Report, RobotRequest, TwinMotionRequest
from gui.console.state.actions import Play, RunBlocks

POLL_S: Final = 0.05
"""Period (s) in which a program that waits looks whether a seat has pressed STOP; `end` ends it at once."""


class BlockRun(Program):
    """One run of a program of blocks; `block` is the id of the present block."""

    def __init__(self, action: RunBlocks, robots: Twin | Robot, own: tuple[Path, ...] = ()) -> None:
        """Store the arguments; `own`: folders of gestures besides that of the user."""
        super().__init__(action.row, action.sides, BOTH if isinstance(robots, Twin) else robots.side)
        self._action, self._robots, self._own = action, robots, own
        self._all = (robots.sim, robots.hw) if isinstance(robots, Twin) else (robots,)
        self._stops: list[StopEvents] = []
        self._part: RobotRequest | None = None
        self._must_end = threading.Event()

    def run(self, report: Report) -> str:
        """Read the program, then carry it out.

        Raises:
            WindowError: the program cannot run.
            Refused, Interrupted, NoAnswer: the error of the first motion that failed.
        """
        with contextlib.ExitStack() as ends:
            try:
                program = read(self._action.program)
                for robot in self._all:
                    check_seat(robot, moves=True)
                    self._stops.append(StopEvents(robot))
                    ends.callback(self._stops[-1].close)
                report(accepted(self.row, self.side, "The program runs.", 0.0))
                Walker(program, self).run()
            except WrongProgram as error:
                self.block = error.block or self.block
                slots = {"text": error.message, **error.slots}
                raise WindowError(error.reason, f"blocks.{error.key}", None, **slots) from error
        return "The program has ended."

    def end(self, why: BeatrixError | None) -> None:
        """End the program and its present motion."""
        super().end(why)
        self._must_end.set()
        if self._part is not None:
            self._part.end(why)

    # -- what the blocks do -------------------------------------------------------------------------

    def begin(self, block: str) -> None:
        """Store the id of the block that begins."""
        self.block = block

    def check(self) -> None:
        """Raise `ending` if there is one; raise Interrupted if a seat has pressed STOP."""
        super().check()
        for stops in self._stops:
            stops.check()

    def look(self, yaw: float, pitch: float, roll: float, speed: float | None) -> None:
        """Turn the head."""
        self._move(pose_query(yaw, pitch, roll, relative=False, speed=speed))

    def move_arm(self, arm: str, angle: float, speed: float | None) -> None:
        """Turn one arm; the others keep their set points."""
        arms = self._all[0].positions().commanded._replace(**{arm: angle})
        self._move(motion_query(*arms, relative=False, speed=speed))

    def home(self, speed: float | None) -> None:
        """Move all arms home."""
        self._move(motion_query(0, 0, 0, relative=False, speed=speed))

    def gesture(self, name: str) -> None:
        """Play a gesture."""
        play = Play(self.row, self.sides, lead_s=self._action.lead_s, gesture=name)
        self._carry_out(Playing(play, self._robots, own=self._own))

    def wait(self, seconds: float) -> None:
        """Wait."""
        until_s = time.monotonic() + seconds
        self.check()
        while (left_s := until_s - time.monotonic()) > 0:
            self._must_end.wait(min(left_s, POLL_S))
            self.check()

    def position(self, part: str) -> float:
        """Return the present angle; with both robots that of the simulation."""
        reading = self._all[0].positions()
        return float(getattr(reading.head if part in AXES.values() else reading.arms, part))

    def _move(self, query: MotionQuery | PoseQuery) -> None:
        robots = self._robots
        if isinstance(robots, Twin):
            self._carry_out(TwinMotionRequest(self.row, robots, query, self._action.lead_s))
        else:
            self._carry_out(OneMotion(self.row, robots, query))

    def _carry_out(self, part: RobotRequest) -> None:
        """Perform a request to its end; if the program must end, stop the robots, unless a newer motion replaces it."""
        self._part = part
        self.check()  # `end` was perhaps called before it could end this part
        motion = part.perform(lambda _: None)
        while not isinstance(motion, str):
            try:
                error = motion.exception(POLL_S)
            except TimeoutError:
                self._check_moving(part)
            else:
                if error is not None:
                    self.check()  # tells more than the end of the motion
                    raise error
                return

    def _check_moving(self, part: RobotRequest) -> None:
        try:
            self.check()
        except BeatrixError as error:
            part.end(error)
            if isinstance(part, OneMotion):
                raise stopped(error, [*self._all]) from error
            raise
