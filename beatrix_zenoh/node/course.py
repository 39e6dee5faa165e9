"""From what was asked to a checked goal in the firmware's units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from beatrix_zenoh._generated.messages import MotionQuery, PoseQuery, Reason, Vector3
from beatrix_zenoh._generated.robot import RobotData
from beatrix_zenoh._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.drive import Arms, Gear
from beatrix_zenoh.errors import Refused
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.limits import Limits
from beatrix_zenoh.rotation import tilt_of
from beatrix_zenoh.trajectory import Trajectory

FURTHEST_STEPS = 2**15 - 1
"""From home: a MOVE's target is an i16."""
POSE_ROUNDING = math.radians(0.1)
"""Poses travel as float32 and start from whole microsteps: the limit itself must pass."""


@dataclass(frozen=True)
class Goal:
    """A motion that was checked: arms in rad, and the same for the firmware."""

    target: Arms
    steps: tuple[int, int, int]
    quarters: tuple[int, int, int]
    straight: bool
    trajectory: Trajectory

    @property
    def duration(self) -> float:
        """Seconds until the arms rest."""
        return self.trajectory.duration

    def frame(self, motion: int) -> Move | MoveStraight:
        """What carries it out."""
        if self.straight:
            return MoveStraight(motion, self.steps, self.quarters[0])
        return Move(motion, self.steps, self.quarters)


class Course:
    """Kinematics, gear and limits of one robot."""

    def __init__(self, robot: RobotData) -> None:
        self.robot = robot
        self.gear = Gear(robot.drive)
        self.neck = Neck(robot.geometry)
        self.limits = Limits(robot)

    def goal(self, query: MotionQuery | PoseQuery, telemetry: Telemetry) -> Goal:
        """Where a query leads from here, checked over the whole path.

        Raises:
            Refused: OUT_OF_REACH, ARM_GAP, YAW_LIMIT, SPEED_LIMIT or BAD_VALUE.
        """
        start = self.gear.to_rad(telemetry.position)
        velocity = self.gear.to_rad(telemetry.velocity)
        straight = isinstance(query, PoseQuery)
        if isinstance(query, PoseQuery):
            target = self._arms_of(query, start)
            top = self.limits.default_speed if query.speed is None else query.speed
            speed = (top, top, top)
        else:
            target = self._arms_asked(query, start)
            default = self.limits.default_speed
            speed = (default, default, default) if query.speed is None else tuple3(query.speed)
        slowest = self.gear.quarters_to_speed((1, 1, 1))
        if any(0 < rate < least for rate, least in zip(speed, slowest, strict=True)):
            raise Refused(
                Reason.SPEED_LIMIT,
                f"Speed {degrees(speed)}/s: the slowest the motors can be told is "
                f"{math.degrees(slowest[0]):.3f} deg/s ({slowest[0]:.5f} rad/s).",
            )
        self.limits.check_speed(speed)
        quarters = self.gear.speed_to_quarters(speed)
        told = self.gear.quarters_to_speed(quarters)  # not what was asked: slow arms would take another way
        trajectory = self.limits.check_motion(start, velocity, target, told, straight=straight)
        steps = self.gear.to_steps(target)
        if max(map(abs, steps)) > FURTHEST_STEPS:
            raise Refused(
                Reason.BAD_VALUE,
                f"Arms at {degrees(target)} are more than {FURTHEST_STEPS} microsteps from home, which no board can be "
                "told: set the head upright and calibrate.",
            )
        return Goal(self.gear.to_rad(steps), steps, quarters, straight, trajectory)

    def _arms_of(self, query: PoseQuery, start: Arms) -> Arms:
        yaw, pitch, roll = query.yaw, query.pitch, query.roll
        if not query.absolute:
            here = self.neck.forward(start)
            yaw, pitch, roll = yaw + here[0], pitch + here[1], roll + here[2]
        tilt, most = tilt_of(pitch, roll), self.limits.tilt_max
        if tilt > most + POSE_ROUNDING:
            raise Refused(
                Reason.OUT_OF_REACH,
                f"Yaw {degrees([yaw])}, pitch {degrees([pitch])}, roll {degrees([roll])} tilts the head by "
                f"{degrees([tilt])}; at most {degrees([most])} is allowed.",
            )
        if abs(yaw) > max(self.limits.yaw_max + math.pi, *map(abs, start)):  # less is judged with its way
            raise Refused(
                Reason.YAW_LIMIT,
                f"Yaw {degrees([yaw])}: the head's cables allow {degrees([self.limits.yaw_max])} either way.",
            )
        return self.neck.inverse(yaw, pitch, roll)

    def _arms_asked(self, query: MotionQuery, start: Arms) -> Arms:
        x, y, z = tuple3(query.position)
        return (x, y, z) if query.absolute else (start[0] + x, start[1] + y, start[2] + z)


def tuple3(value: Vector3) -> Arms:
    """A Vector3 as a tuple."""
    return value.x, value.y, value.z


def vector(arms: Arms) -> Vector3:
    """A tuple as a Vector3."""
    return Vector3(*arms)


def degrees(arms: Sequence[float]) -> str:
    """Angles for people: `5.0, -2.1, 0.0 deg`."""
    return ", ".join(f"{math.degrees(angle):z.1f}" for angle in arms) + " deg"
