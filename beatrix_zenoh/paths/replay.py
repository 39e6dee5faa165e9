"""Replay of a path: sends targets at their times, to one robot or to both."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Final

from msgspec.structs import astuple, replace

from beatrix_zenoh.client.choreography import stopping
from beatrix_zenoh.client.degrees import arm_angles, checked_seconds, motion_query
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_base import offset_of
from beatrix_zenoh.client.stopping import StopEvents
from beatrix_zenoh.client.twin import Twin
from beatrix_zenoh.client.twin_motion import ended, furthest
from beatrix_zenoh.contract._generated.messages import MotionQuery, Reason, Source
from beatrix_zenoh.contract.errors import Interrupted, Refused, naming, wrong_usage
from beatrix_zenoh.paths.follow import LEAD_IN_S, Following

POLL_S: Final = 0.02
"""Period of checks while no target is due."""
LATE_S: Final = 0.5
"""A target that is late by more than this is not sent: the program was suspended, and the robot has stopped."""
THERE_DEG: Final = 0.1
"""Tolerance of the position at the start of the path; a microstep is 0.086 deg."""
BEGIN_S: Final = 0.05 + LEAD_IN_S
"""Time from the arrival of the robots at the start until the path begins."""
CORRECT_S: Final = 0.2
"""Time within which a deviation from the plan is corrected."""
FASTER: Final = 1.5
"""Largest factor between the planned speed and the speed that corrects a deviation."""
BAD_SPEED_REASONS: Final = (Reason.OUT_OF_REACH, Reason.ARM_GAP, Reason.YAW_LIMIT, Reason.SPEED_LIMIT)
Progress = Callable[[float], None]
"""A function that is called with the elapsed time of the path (s)."""


class TargetStream:
    """The targets for one robot, sent `delay_s` (s) after their times.

    `lead_s` is the lead (s) of both robots, None for one robot.
    """

    def __init__(self, robot: Robot, following: Following, delay_s: float, lead_s: float | None) -> None:
        """Measure the robot's clock, and subscribe to its positions and STOPs; raises NoAnswer."""
        self.robot = robot
        self._following = following
        self._clock_s = offset_of(robot).certain
        self._positions = robot.positions_stream(None)
        self._stops = StopEvents(robot)
        self._coming = iter(following.targets)
        self._next = next(self._coming, None)
        self._delay_s, self._lead_s = delay_s, lead_s
        self._begin_s = math.inf
        self.motion: Motion | None = None

    def start(self, begin_s: float) -> None:
        """Start the path at `begin_s` (s, monotonic clock) plus the delay."""
        self._begin_s = begin_s + self._delay_s

    @property
    def due_s(self) -> float | None:
        """Time of the next target by the monotonic clock (s); None: all were sent."""
        return None if self._next is None else self._begin_s + self._next.t

    @property
    def done(self) -> bool:
        """Whether all targets were sent and the last was reached."""
        return self._next is None and self.motion is None

    def advance(self) -> None:
        """Check that the robot still follows the path, and send the target that is due.

        Raises:
            Interrupted: STOP was pressed, another motion replaced this one, or this program was suspended.
            Refused: the robot refuses the target.
            NoAnswer: the robot is lost.
        """
        self._stops.check()
        if self.motion is not None and ended(self.robot, self.motion, 0.0):
            self.motion = None
        if self._next is None or self.due_s is None:
            return
        late_s = time.monotonic() - self.due_s
        if late_s < 0:
            return
        if late_s > LATE_S:
            raise Interrupted(
                Reason.STOPPED,
                f"{self.robot}: this program was suspended for {late_s:.1f} s, so the robot is no longer on the path. "
                "Close other programs and try again.",
            )
        target, self._next = self._next, next(self._coming, None)
        query = replace(target.query, source=Source.REPLAY, lead=self._lead_s)
        with naming(str(self.robot)):
            try:
                self.motion = self.robot.begin(self._corrected(query))
            except Refused as refusal:
                if refusal.reason not in BAD_SPEED_REASONS:
                    raise
                # The corrected speeds may exceed a limit, so use those of the plan.
                self.motion = self.robot.begin(query)

    def _corrected(self, query: MotionQuery) -> MotionQuery:
        """Return the target with speeds that correct the deviation from the plan.

        Deviations arise because targets arrive with a varying delay.
        """
        newest = self._positions.latest
        if newest is None or query.speed is None:
            return query
        t = newest.t_mono_ns / 1e9 - self._clock_s - self._begin_s
        if t < -LEAD_IN_S:
            return query
        here = arm_angles(newest.commanded)
        short, middle, long = (
            min(self._following.fastest, corrected(math.degrees(speed), goal - at, planned - at))
            for speed, goal, at, planned in zip(
                astuple(query.speed), arm_angles(query.position), here, self._following.at(t), strict=True
            )
        )
        speed = motion_query(0, 0, 0, relative=False, speed=(short, middle, long)).speed
        return replace(query, speed=speed)

    def close(self) -> None:
        """End the subscriptions."""
        self._positions.close()
        self._stops.close()


def corrected(speed: float, way: float, behind: float) -> float:
    """Return the speed (deg/s) that corrects a deviation `behind` (deg) within CORRECT_S, limited by FASTER.

    `speed` is the planned speed (deg/s), `way` the remaining way (deg).
    """
    more = math.copysign(behind / CORRECT_S, behind * way)
    return min(FASTER * speed, max(speed / FASTER, speed + more))


def replay(
    robots: Twin | Robot,
    following: Following,
    progress: Progress = lambda _passed_s: None,
    *,
    lead_s: float = 0.0,
) -> None:
    """Move to the start of a path, then follow it; the hardware moves `lead_s` (s) after the simulation.

    With both robots, the motion to the start is previewed on a copy of the simulation. If one robot refuses a target or
    is stopped, both are stopped and the replay ends. Ctrl-C stops both; the KeyboardInterrupt names their positions.

    Raises:
        WrongUsage: `lead_s` is not a valid time, or is given for one robot.
        Refused, Interrupted, NoAnswer: the motion to the start or a target failed.
    """
    lead_s = checked_seconds("lead_s", lead_s, zero=True)
    if lead_s and isinstance(robots, Robot):
        raise wrong_usage("lead_s needs both robots: omit it for one robot.")
    _go_to_start(robots, following)
    delays = {robots: 0.0} if isinstance(robots, Robot) else {robots.sim: 0.0, robots.hw: lead_s}
    both_s = None if isinstance(robots, Robot) else lead_s
    streams = [TargetStream(robot, following, delay_s, both_s) for robot, delay_s in delays.items()]
    begin_s = time.monotonic() + BEGIN_S
    for stream in streams:
        stream.start(begin_s)
    with stopping(streams):
        while not all(stream.done for stream in streams):
            for stream in streams:
                stream.advance()
            now_s = time.monotonic()
            progress(min(following.path.duration_s, max(0.0, now_s - begin_s)))
            due_s = min(
                (stream.due_s for stream in streams if stream.due_s is not None), default=now_s + POLL_S
            )
            time.sleep(min(POLL_S, max(0.0, due_s - now_s)))


def _go_to_start(robots: Twin | Robot, following: Following) -> None:
    """Move to the start of the path, unless the robots are already at it."""
    start = replace(following.start, source=Source.REPLAY)
    if isinstance(robots, Robot):
        if _away_from_start(robots, following):
            robots.begin(start).wait()
        return
    robots.check_ready()
    if _away_from_start(robots.sim, following) or _away_from_start(robots.hw, following):
        robots.preview_query(start).commit()


def _away_from_start(robot: Robot, following: Following) -> bool:
    """Return whether the robot is further than THERE_DEG from the start of the path."""
    return furthest(robot.positions().commanded, arm_angles(following.start.position)) > THERE_DEG
