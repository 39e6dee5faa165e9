"""Held buttons: robots move while heartbeats arrive, because each heartbeat is one goal half a second ahead."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from beatrix_zenoh.client import Motion, Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import accepted, done, failed
from gui.console.state.actions import Hold, Outcome
from gui.console.state.arms import AHEAD_S, jog_query

BRAKE_S: Final = 0.12
"""Like AHEAD_S, for the last goal of a jog: an arm at 40 deg/s needs 0.11 s to come to rest."""
SMALLEST_DEG: Final = 0.5
"""Shortest motion of a jog near a limit."""
LIMITS: Final = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT)


@dataclass(frozen=True, eq=False)
class Press:
    """A press of a button."""

    asked: Hold
    robots: tuple[Robot, ...]

    def query(self, ahead_s: float) -> MotionQuery | PoseQuery:
        """Return the motion from the present set point for `ahead_s`."""
        return jog_query(self.asked.part, self.asked.sign, self.asked.speed, ahead_s)


class Jogging:
    """Sends the goals of held buttons in a queue of their own; the newest goal replaces one that waits."""

    def __init__(self, jobs: Jobs, report: Callable[[Outcome], None]) -> None:
        self._jobs, self._report = jobs, report
        self._lock = threading.Lock()
        self._press: Press | None = None
        self._goal: tuple[Press, float] | None = None
        self.over = 0
        """All presses up to this row have ended."""
        self._stops = 0
        self._running: dict[str, tuple[int, Motion]] = {}
        """By side: the row and motion begun last, until its end."""

    @property
    def busy(self) -> bool:
        """Whether robots move, or are about to move, for a held button."""
        return self._goal is not None or bool(self._running)

    def is_new(self, row: int) -> bool:
        """Return whether the press of this row has not begun yet; late heartbeats of earlier presses are ignored."""
        return row > max(self.over, 0 if self._press is None else self._press.asked.row)

    def begin(self, press: Press) -> None:
        """Begin a press, which ends an earlier one."""
        self._put(press, press, AHEAD_S)

    def go_on(self, row: int) -> None:
        """Continue the press of this row, unless it has ended."""
        press = self._press
        if press is not None and press.asked.row == row:
            self._put(press, press, AHEAD_S)

    def release(self, row: int) -> None:
        """End the press of this row: the robots come to rest at a last goal."""
        press = self._press
        self.over = max(self.over, row)
        if press is not None and press.asked.row == row:
            self._put(None, press, BRAKE_S)

    def _put(self, held: Press | None, press: Press, ahead_s: float) -> None:
        with self._lock:
            self._press, self._goal = held, (press, ahead_s)
        self._jobs.put("jog", self._step)

    def end(self, *, stopped: bool = False) -> None:
        """End the press without a last goal; `stopped`: STOP was sent, also to a goal that is being sent."""
        with self._lock:
            self._stops += stopped
            self._goal = None
            self._drop(self._press)

    def _failed(self, press: Press) -> None:
        """End a press without a last goal, but none that has begun since: a motion that STOP ends reports it later."""
        with self._lock:
            if self._goal is not None and self._goal[0] is press:
                self._goal = None
            self._drop(press)

    def _drop(self, press: Press | None) -> None:
        """End a press if it is held; the caller holds the lock."""
        if press is not None and self._press is press:
            self.over, self._press = max(self.over, press.asked.row), None

    # -- one after the other -----------------------------------------------------------------------

    def _step(self) -> None:
        with self._lock:
            goal, self._goal, stops = self._goal, None, self._stops
        if goal is None:
            return
        press, ahead_s = goal
        for robot in press.robots:
            try:
                self._begin(press, robot, ahead_s, stops)
            except BeatrixError as error:
                self._failed(press)
                self._report(failed(press.asked.row, robot.side, error))
                return

    def _begin(self, press: Press, robot: Robot, ahead_s: float, stops: int) -> None:
        """Send one goal, near a limit a shorter one; raises Refused if no goal is accepted."""
        began_s, motion = time.monotonic(), None
        while motion is None:
            try:
                motion = robot.begin(press.query(ahead_s))
            except Refused as error:
                ahead_s /= 2
                if error.reason not in LIMITS or press.asked.speed * ahead_s < SMALLEST_DEG:
                    raise
        first = self._running.get(robot.side, (0, None))[0] != press.asked.row
        self._running[robot.side] = press.asked.row, motion
        if self._stops != stops:  # the STOP sent meanwhile may have arrived before the goal
            publish_stop(robot.client, robot.place)
        if first:
            self._report(accepted(press.asked.row, robot.side, motion.accepted.message, 0.0))
        motion.add_done_callback(lambda motion: self._ended(press, robot.side, motion, began_s))

    def _ended(self, press: Press, side: str, motion: Motion, began_s: float) -> None:
        newest = self._running.get(side) == (press.asked.row, motion)
        if newest:
            del self._running[side]
        error = motion.exception(0.0)
        if error is not None and error.reason is not Reason.REPLACED:
            self._failed(press)
            self._report(failed(press.asked.row, side, error))
        elif error is None and newest and press.asked.row <= self.over:
            self._report(done(press.asked.row, side, motion.result(0.0).message, time.monotonic() - began_s))
