"""Positions in degrees."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import msgspec

from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.contract._generated.messages import Head, Info, KeyInfo, Positions, Vector3
from beatrix_zenoh.contract.errors import BeatrixError


class ArmAngles(NamedTuple):
    """One number per arm, deg or deg/s."""

    short: float
    middle: float
    long: float

    def __str__(self) -> str:
        return f"short {self.short:z.1f}°, middle {self.middle:z.1f}°, long {self.long:z.1f}°"


class HeadAngles(NamedTuple):
    """Orientation of the head (deg): yaw left, pitch nose-down, roll right-ear-down positive."""

    yaw: float
    pitch: float
    roll: float

    def __str__(self) -> str:
        return f"yaw {self.yaw:z.1f}°, pitch {self.pitch:z.1f}°, roll {self.roll:z.1f}°"


@dataclass(frozen=True)
class Reading(Suggesting):
    """Positions (deg) and velocity (deg/s) of a robot; `t` is the time (s) by the source's monotonic clock."""

    t: float
    arms: ArmAngles
    velocity: ArmAngles
    commanded: ArmAngles
    head: HeadAngles

    def __str__(self) -> str:
        return f"head: {self.head}; arms: {self.arms}"


@dataclass(frozen=True)
class Path:
    """A previewed path: times in s, arms and head in deg."""

    t: list[float]
    arms: list[ArmAngles]
    head: list[HeadAngles]


class RobotLimits(NamedTuple):
    """Limits of every motion of a robot (deg, deg/s, deg/s2)."""

    tilt_max: float
    """largest tilt of the head"""
    gap_min: float
    """smallest gap between neighbouring arms"""
    yaw_max: float
    """largest yaw of the head in either direction"""
    speed_default: float
    """default speed of an arm"""
    speed_max: float
    """largest speed of an arm"""
    acceleration: float
    """acceleration of an arm"""


class RobotGeometry(NamedTuple):
    """Geometry of the neck (deg), as in docs/reference/robot.md."""

    arm_angle: float
    rod_twist: float
    mount_angle: float
    arm0_azimuth: float
    arm_spacing: float
    hand: int
    """+1: rods run counter-clockwise from arm to mount, -1: clockwise"""


class RobotInfo(msgspec.Struct, frozen=True):
    """The message Info, with limits and geometry in degrees."""

    robot: str
    side: str
    version: str
    contract: str
    firmware: str
    steps_per_turn: float
    """microsteps per turn of an arm"""
    arms: list[str]
    limits: RobotLimits
    geometry: RobotGeometry | None
    """None: the node has an older version, which does not send it"""
    fingerprint: str | None
    """hash of all values of the robot"""
    commands: list[str]
    reasons: list[str]
    keys: list[KeyInfo]
    examples: list[str]


class Suggestion(NamedTuple):
    """An allowed alternative to a refused motion (deg, deg/s); None: not part of the alternative."""

    arms: ArmAngles | None
    """arguments for `Robot.move`"""
    head: HeadAngles | None
    """arguments for `Robot.look`"""
    speed: ArmAngles | None


def suggestion(refusal: BeatrixError) -> Suggestion | None:
    """Return the checked alternative in a refusal's `detail`, in degrees; None if the refusal has none."""
    other = None if refusal.detail is None else refusal.detail.alternative
    if other is None:
        return None
    return Suggestion(
        None if other.arms is None else arm_angles(other.arms),
        None if other.head is None else head_angles(other.head),
        None if other.speed is None else arm_angles(other.speed),
    )


def arm_angles(vector: Vector3) -> ArmAngles:
    """Convert angles or speeds of the arms from rad to degrees."""
    return ArmAngles(*(math.degrees(value) for value in (vector.x, vector.y, vector.z)))


def head_angles(head: Head) -> HeadAngles:
    """Convert the orientation of the head from rad to degrees."""
    return HeadAngles(*(math.degrees(value) for value in (head.yaw, head.pitch, head.roll)))


def robot_info(info: Info) -> RobotInfo:
    """Convert the limits and the geometry in an info to degrees."""
    limits, geometry = msgspec.structs.asdict(info.limits), None
    if info.geometry is not None:
        angles = msgspec.structs.asdict(info.geometry)
        hand = angles.pop("hand")
        geometry = RobotGeometry(**{name: _degrees(angle) for name, angle in angles.items()}, hand=hand)
    return RobotInfo(
        **{
            **msgspec.structs.asdict(info),
            "limits": RobotLimits(**{name: _degrees(value) for name, value in limits.items()}),
            "geometry": geometry,
        }
    )


def _degrees(angle: float) -> float:
    """Convert a float32 angle (rad) to degrees, rounded to remove the error of float32."""
    return round(math.degrees(angle), 4)


def reading(positions: Positions) -> Reading:
    """Convert the positions in a message to degrees."""
    return Reading(
        t=positions.t_mono_ns / 1e9,
        arms=arm_angles(positions.position),
        velocity=arm_angles(positions.velocity),
        commanded=arm_angles(positions.commanded),
        head=head_angles(positions.head),
    )
