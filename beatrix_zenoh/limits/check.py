"""What the neck may do, and the sentence that says why not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.limits.refusal import Asked, Judge, degrees, listed
from beatrix_zenoh.limits.walk import Limit, Walker
from beatrix_zenoh.trajectory import Trajectory

_REACH_MARGIN: Final = math.radians(1.0)
_ROUNDING: Final = 1e-9
_SPEED_ROUNDING: Final = 1.001
"""Speeds travel as float32 and in quarter microsteps: the limit itself must pass."""
_FURTHEST_START: Final = 1000.0
"""rad; counters that say more are wrong"""
_FASTEST_START: Final = 10.0
"""times the speed limit; the same for velocities"""


class Limits:
    """Limits of one robot, in rad, rad/s and rad/s2."""

    def __init__(self, robot: RobotData = ROBOT) -> None:
        """Raise Refused (BAD_VALUE) if the geometry is no neck, or one that cannot tilt as far as it may."""
        data = robot.limits
        self._neck = Neck(robot.geometry)
        self.tilt_max = math.radians(data.tilt_max)
        if self.tilt_max > self._neck.reach - _REACH_MARGIN + _ROUNDING:
            raise Refused(
                Reason.BAD_VALUE,
                f"tilt_max is {data.tilt_max:g} deg, but the rods reach {math.degrees(self._neck.reach):.1f} deg in every "
                "direction, and a degree of that is needed to spare.",
            )
        self.gap_min = math.radians(data.gap_min)
        self.yaw_max = math.radians(data.yaw_max)
        self.speed_max = math.radians(data.speed_max)
        self.acceleration = math.radians(data.acceleration)
        self.default_speed = math.radians(data.speed_default)
        limit = Limit(self.tilt_max, self.yaw_max, self.gap_min)
        self._judge = Judge(self._neck, Walker(self._neck, limit), limit, self.acceleration)

    def check_pose(self, arms: Sequence[float]) -> None:
        """Raise Refused if the head must not rest with the arms (rad) there: BAD_VALUE or any limit of a pose."""
        self._judge.sane(arms)
        self._judge.pose(arms)

    def check_speed(self, speed: Sequence[float]) -> None:
        """Raise Refused (SPEED_LIMIT, BAD_VALUE) unless the speeds (rad/s) of all arms are > 0 and allowed."""
        if not all(math.isfinite(value) for value in speed):
            raise Refused(
                Reason.BAD_VALUE, f"Speed {listed(speed)} rad/s: every speed must be a finite number."
            )
        top = math.degrees(self.speed_max)
        if not all(0 < value <= self.speed_max * _SPEED_ROUNDING for value in speed):
            raise Refused(
                Reason.SPEED_LIMIT,
                f"Speed {degrees(speed[:1] if len(set(speed)) == 1 else speed)} deg/s: every arm needs more than 0 and at most {top:.1f} deg/s "
                f"({self.speed_max:.3f} rad/s).",
            )

    def check_motion(
        self, start: Arms, velocity: Arms, target: Arms, speed: Arms, *, straight: bool
    ) -> Trajectory:
        """A motion that keeps all limits on its whole way; else raises Refused.

        start: where the arms are set now (rad), moving with velocity (rad/s). target: rad. speed: rad/s, see
        `trajectory.plan`. A start beyond a limit may be left by a motion that only leads back.
        Reasons: BAD_VALUE, SPEED_LIMIT, ARM_GAP, YAW_LIMIT, OUT_OF_REACH.
        """
        self.check_speed(speed)
        self._check_start(start, velocity)
        self._judge.sane(target, start)
        asked = Asked(start, velocity, target, speed, straight)
        trajectory = asked.trajectory(self.acceleration)
        breach = self._judge.walk(trajectory)
        if breach is not None:
            raise self._judge.refusal(breach, asked)
        return trajectory

    def _check_start(self, start: Arms, velocity: Arms) -> None:
        fastest = self.speed_max * _FASTEST_START
        if all(abs(x) <= _FURTHEST_START for x in start) and all(abs(x) <= fastest for x in velocity):
            return
        raise Refused(
            Reason.BAD_VALUE,
            f"The arms are said to be at {listed(start)} rad, moving with {listed(velocity)} rad/s: that cannot be; "
            "set the head upright and calibrate.",
        )
