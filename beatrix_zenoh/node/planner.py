"""Planning: convert queries to checked goals in the units of the firmware."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from msgspec import structs

from beatrix_zenoh import sentences
from beatrix_zenoh._generated.messages import (
    Alternative,
    Detail,
    Limit,
    MotionQuery,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh._generated.robot import RobotData
from beatrix_zenoh._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import SLOWEST_LIMIT_DEG, Limits, with_alternative
from beatrix_zenoh.motion.trajectory import Trajectory
from beatrix_zenoh.refusals import ARMS


@dataclass(frozen=True)
class Goal:
    """A checked motion: arm angles `target` (rad); for the firmware `steps` (microsteps) and speeds `quarters`.

    `quarters` are quarter microsteps per second.
    """

    target: Arms
    steps: tuple[int, int, int]
    quarters: tuple[int, int, int]
    straight: bool
    trajectory: Trajectory

    @property
    def duration(self) -> float:
        """Time (s) until the arms rest."""
        return self.trajectory.duration

    def frame(self, motion: int) -> Move | MoveStraight:
        """Return the frame that begins the motion to this goal, with the number `motion`."""
        if self.straight:
            return MoveStraight(motion, self.steps, self.quarters[0])
        return Move(motion, self.steps, self.quarters)


class Planner:
    """Converts queries of one robot to checked goals: kinematics, gear and limits."""

    def __init__(self, robot: RobotData) -> None:
        self.robot = robot
        self.gear = Gear(robot.drive)
        self.neck = Neck(robot.geometry)
        self.limits = Limits(robot)
        self.speed_limit = 0.0
        """Limit (rad/s) that the teacher has set for every arm; 0: none."""

    def limit_speed(self, speed: float) -> None:
        """Limit the speed of every arm to `speed` (rad/s), also in motions without a speed; 0 ends the limit.

        Raises:
            Refused: SPEED_LIMIT, `speed` is lower than SLOWEST_LIMIT_DEG or higher than the robot allows.
        """
        own = self.robot.limits
        low, high = math.radians(SLOWEST_LIMIT_DEG), math.radians(own.speed_max)
        if speed and not low * 0.999 <= speed <= high * 1.001:
            raise Refused(
                Reason.SPEED_LIMIT,
                detail=Detail(
                    limit=Limit.SPEED, value=speed, low=low, high=high, unit="rad/s", arms=list(ARMS)
                ),
            )
        # Undo the rounding of messages to single precision, so that status and texts show the limit as it was typed.
        speed = math.radians(round(math.degrees(speed), 3))
        speed_max = math.degrees(speed) if speed else own.speed_max
        limits = structs.replace(own, speed_max=speed_max, speed_default=min(own.speed_default, speed_max))
        self.limits = Limits(structs.replace(self.robot, limits=limits))
        self.speed_limit = speed

    def exceeds_limit(self, goal: Goal) -> bool:
        """Return whether a motion, which may have begun before the teacher set the limit, exceeds it."""
        fastest = max(self.gear.quarters_to_speed(goal.quarters))
        return 0 < self.speed_limit < fastest * 0.999

    def goal(self, query: MotionQuery | PoseQuery, telemetry: Telemetry) -> Goal:
        """Return the goal of a query, checked over the whole path from the state in the telemetry.

        Raises:
            Refused: OUT_OF_REACH, ARM_GAP, YAW_LIMIT, SPEED_LIMIT or BAD_VALUE.
        """
        speed = self._speed_of(query)
        try:
            self.limits.check_speed(speed)
        except Refused as refusal:
            raise self._with_speed(refusal, query, telemetry, speed) from None
        return self._goal(query, telemetry, speed)

    def _goal(self, query: MotionQuery | PoseQuery, telemetry: Telemetry, speed: Arms) -> Goal:
        start = self.gear.to_rad(telemetry.position)
        velocity = self.gear.to_rad(telemetry.velocity)
        quarters = self.gear.speed_to_quarters(speed)
        sent = self.gear.quarters_to_speed(quarters)  # check these: rounding changes paths of slow arms
        straight = isinstance(query, PoseQuery)
        if isinstance(query, PoseQuery):
            target = self.limits.arms_for(self._pose_of(query, start), start, velocity, sent)
        else:
            x, y, z = tuple3(query.position)
            target = (x, y, z) if query.absolute else (start[0] + x, start[1] + y, start[2] + z)
        trajectory = self.limits.check_motion(start, velocity, target, sent, straight=straight)
        steps = self.gear.to_steps(target)
        return Goal(self.gear.to_rad(steps), steps, quarters, straight, trajectory)

    def _speed_of(self, query: MotionQuery | PoseQuery) -> Arms:
        """Return the speed of each arm (rad/s), the default if the query has none."""
        if isinstance(query.speed, Vector3):
            return tuple3(query.speed)
        speed = self.limits.default_speed if query.speed is None else query.speed
        return speed, speed, speed

    def _with_speed(
        self, refusal: Refused, query: MotionQuery | PoseQuery, telemetry: Telemetry, speed: Arms
    ) -> Refused:
        """Complete and return the refusal of a speed.

        Name the teacher's limit if it is exceeded, and the nearest allowed speed if the motion is accepted with it.
        """
        if refusal.reason is not Reason.SPEED_LIMIT or refusal.detail is None:
            return refusal
        if self.speed_limit and max(speed) > self.speed_limit:
            refusal = Refused(
                refusal.reason, detail=structs.replace(refusal.detail, field=sentences.TEACHER_LIMIT)
            )
        nearest = self.limits.nearest_speed(speed)
        try:
            self._goal(query, telemetry, nearest)
        except Refused:
            return refusal
        return with_alternative(refusal, Alternative(speed=vector(nearest)))

    def _pose_of(self, query: PoseQuery, start: Arms) -> Arms:
        """Return yaw, pitch and roll (rad) of the goal."""
        if query.absolute:
            return query.yaw, query.pitch, query.roll
        yaw, pitch, roll = self.limits.head_at(start)
        return yaw + query.yaw, pitch + query.pitch, roll + query.roll


def tuple3(value: Vector3) -> Arms:
    """Convert a Vector3 to a tuple."""
    return value.x, value.y, value.z


def vector(arms: Arms) -> Vector3:
    """Convert a tuple to a Vector3."""
    return Vector3(*arms)


def degrees(arms: Sequence[float]) -> str:
    """Format angles (rad) for the user: `5.0°, -2.1°, 0.0°`."""
    return ", ".join(f"{math.degrees(angle):z.1f}°" for angle in arms)
