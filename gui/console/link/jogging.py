"""Held buttons: robots move while heartbeats arrive, because each heartbeat is one goal half a second ahead."""

from __future__ import annotations

import contextlib
import queue
from typing import Final

from beatrix_zenoh.client import Motion, Robot
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.client.twin_motion import ended
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused, naming
from beatrix_zenoh.processes import POLL_S
from gui.console.link.outcomes import accepted
from gui.console.link.request import BOTH, Program, Report
from gui.console.state.actions import Hold, Shares
from gui.console.state.arms import AHEAD_S, jog_query

BRAKE_S: Final = 0.12
"""Like AHEAD_S, for the last goal of a jog: an arm at 40 deg/s needs 0.11 s to come to rest."""
SMALLEST_DEG: Final = 0.5
"""Shortest motion of a jog near a limit."""
LIMITS: Final = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT)


class Held(Program):
    """The motion of one press."""

    def __init__(self, asked: Hold, robots: tuple[Robot, ...]) -> None:
        """Store the arguments."""
        super().__init__(asked.row, asked.sides, BOTH if len(robots) > 1 else robots[0].side)
        self._asked, self._robots = asked, robots
        self._shares = asked.shares
        self._goals: queue.SimpleQueue[float] = queue.SimpleQueue()
        """how far ahead the next goals are (s)"""
        self._held = True

    def beat(self, shares: Shares) -> None:
        """Go on, with these speeds, until AHEAD_S from now; returns at once."""
        self._shares = shares
        self._goals.put(AHEAD_S)

    def release(self) -> None:
        """End the press: the robots come to rest at a last goal."""
        self._goals.put(BRAKE_S)
        self._held = False

    def run(self, report: Report) -> str:
        """Send goals until the robots rest after the release."""
        motions: dict[Robot, Motion] = {}
        while True:
            rests = [ended(robot, motion, 0.0) for robot, motion in motions.items()]
            released, ahead_s = not self._held, self._newest_goal()
            self.check()
            if not ahead_s and released and all(rests):
                return motions[self._robots[-1]].result(0.0).message
            for robot in self._robots if ahead_s else ():
                motions[robot] = self._begin(robot, ahead_s)
            if motions and not rests:
                report(accepted(self.row, self.side, motions[self._robots[0]].accepted.message, 0.0))

    def _newest_goal(self) -> float:
        """Return how far ahead the next goal is (s); 0 if there is none for POLL_S."""
        ahead_s = 0.0
        with contextlib.suppress(queue.Empty):
            ahead_s = self._goals.get(timeout=POLL_S)
            while True:
                ahead_s = self._goals.get_nowait()
        return ahead_s

    def _begin(self, robot: Robot, ahead_s: float) -> Motion:
        """Send one goal, near a limit a shorter one; raises Refused if no goal is accepted."""
        asked, shares, motion = self._asked, self._shares, None
        with naming(str(robot)) if self.side == BOTH else contextlib.nullcontext():
            while motion is None:
                try:
                    motion = robot.begin(jog_query(shares, asked.speed, ahead_s))
                except Refused as error:
                    ahead_s /= 2
                    if error.reason not in LIMITS or asked.speed * ahead_s < SMALLEST_DEG:
                        raise
        if self.ending is not None and self.ending.reason is not Reason.REPLACED:
            publish_stop(
                robot.client, robot.place
            )  # the STOP sent meanwhile may have arrived before the goal
        return motion
