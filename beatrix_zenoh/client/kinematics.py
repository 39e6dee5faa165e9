"""Kinematics of one robot, in degrees, and the direction of a place in the room."""

from __future__ import annotations

import math

from msgspec.structs import replace

from beatrix_zenoh.client.degrees import (
    ArmAngles,
    HeadAngles,
    RobotGeometry,
    RobotInfo,
    RobotLimits,
    to_rad,
)
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, GeometryData, RobotData
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion.kinematics import Neck

EYE_UP_M = ROBOT.head.centre_height + SIZES.eye_up
"""Height of the eyes above the neck's centre while the head is upright."""


def robot_of(info: RobotInfo) -> RobotData:
    """Return robot data with the limits and the geometry of this info, in the units of robot.toml."""
    shape = info.geometry
    geometry = ROBOT.geometry if shape is None else GeometryData(**shape._asdict())
    return replace(ROBOT, geometry=geometry, limits=replace(ROBOT.limits, **info.limits._asdict()))


class Kinematics:
    """Inverse and forward kinematics of one robot; they need no connection. See `beatrix_zenoh.motion.kinematics`."""

    def __init__(self, info: RobotInfo) -> None:
        robot = robot_of(info)
        self.geometry = RobotGeometry(
            **{name: getattr(robot.geometry, name) for name in RobotGeometry._fields}
        )
        """Geometry of the neck (deg)"""
        self.limits: RobotLimits = info.limits
        """Limits of every motion (deg, deg/s, deg/s2); `inverse` and `forward` do not check them: see `Robot.preview`"""
        self._neck = Neck(robot.geometry)

    def inverse(self, yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0) -> ArmAngles:
        """Return the arm angles (deg) for an orientation of the head (deg).

        Raises:
            Refused: OUT_OF_REACH if rods and arms cannot reach it.
            WrongUsage: an angle is not a finite number.
        """
        angles = (to_rad("yaw", yaw), to_rad("pitch", pitch), to_rad("roll", roll))
        return ArmAngles(*map(math.degrees, self._neck.inverse(*angles)))

    def forward(self, short: float, middle: float, long: float) -> HeadAngles:
        """Return the orientation of the head (deg) for arm angles (deg).

        Raises:
            BeatrixError: OUT_OF_REACH if the rods do not fit these arms.
            WrongUsage: an angle is not a finite number.
        """
        arms = (to_rad("short", short), to_rad("middle", middle), to_rad("long", long))
        return HeadAngles(*map(math.degrees, self._neck.forward(arms)))


def bearing(x: float, y: float, z: float) -> tuple[float, float]:
    """Return yaw and pitch (deg) of a head whose eyes look at a place (m, in the frame of the neck's centre).

    The head turns about the neck's centre, and the eyes are EYE_UP_M above it: after the yaw, the place must be as high
    above the head's x axis as the eyes are. Raises WrongUsage (BAD_VALUE) for a place too near for that.
    """
    away = math.hypot(x, y)
    distance = math.hypot(away, z)
    if distance <= EYE_UP_M or away == 0.0:
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"The place is {distance:.2f} m from the neck's centre, in or straight above the head: choose one further "
            "away, for example look_at(1, 0, 0.16).",
        )
    return math.degrees(math.atan2(y, x)), math.degrees(math.asin(EYE_UP_M / distance) - math.atan2(z, away))
