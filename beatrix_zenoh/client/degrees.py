"""Degrees of the SDK and radians of the messages: positions and previews that are read, kinematics, and arguments.

Invalid arguments are rejected before sending.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, NamedTuple

import msgspec
from msgspec.structs import replace

from beatrix_zenoh.client.figures import time_figure
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.colours import ARMS, AXES
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    Head,
    Info,
    MotionQuery,
    PoseQuery,
    Positions,
    PreviewReply,
    Vector3,
)
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, GeometryData, LimitsData, RobotData
from beatrix_zenoh.contract.errors import BeatrixError, wrong_usage
from beatrix_zenoh.motion.kinematics import Neck

if TYPE_CHECKING:
    from beatrix_zenoh.client.figures import Figure

EYE_UP_M = ROBOT.head.centre_height + SIZES.eye_up
"""Height of the eyes above the neck's centre while the head is upright."""
DAY_S = 86400.0
REST_DEG = 0.3
"""An arm that turns by less than this is at rest."""
SLOWEST, FASTEST = 0.01, 100.0
"""Range of speed factors."""
Speed = float | Sequence[float]
"""Top speed in deg/s: one number for all arms, or three: short, middle, long."""


class ArmAngles(NamedTuple):
    """One number per arm, deg or deg/s."""

    short: float
    middle: float
    long: float

    def __str__(self) -> str:
        return f"short {self.short:z.1f}°, middle {self.middle:z.1f}°, long {self.long:z.1f}°"

    def __repr__(self) -> str:
        return f"ArmAngles(short={self.short:z.2f}, middle={self.middle:z.2f}, long={self.long:z.2f})"


class HeadAngles(NamedTuple):
    """Orientation of the head (deg): yaw left, pitch nose-down, roll right-ear-down positive."""

    yaw: float
    pitch: float
    roll: float

    def __str__(self) -> str:
        return f"yaw {self.yaw:z.1f}°, pitch {self.pitch:z.1f}°, roll {self.roll:z.1f}°"

    def __repr__(self) -> str:
        return f"HeadAngles(yaw={self.yaw:z.2f}, pitch={self.pitch:z.2f}, roll={self.roll:z.2f})"


@dataclass(frozen=True, repr=False)
class Reading(Suggesting):
    """Positions (deg) and velocity (deg/s) of a robot; `t` is the time (s) by the source's monotonic clock."""

    t: float
    arms: ArmAngles
    velocity: ArmAngles
    commanded: ArmAngles
    """the set point of the firmware"""
    head: HeadAngles

    def __str__(self) -> str:
        return f"head: {self.head}; arms: {self.arms}"

    def __repr__(self) -> str:
        return f"<reading at {self.t:.2f} s; {self}>"


@dataclass(frozen=True)
class Path:
    """A previewed path: times in s, arms and head in deg."""

    t: list[float]
    arms: list[ArmAngles]
    head: list[HeadAngles]


class RobotInfo(Info, frozen=True, kw_only=True):
    """The message Info, with limits and geometry in degrees."""

    limits: LimitsData  # type: ignore[assignment]
    geometry: GeometryData | None = None  # type: ignore[assignment]
    """None: the node has an older version, which does not send it"""


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
        geometry = GeometryData(**{name: _degrees(angle) for name, angle in angles.items()}, hand=hand)
    changed = {
        "limits": replace(ROBOT.limits, **{name: _degrees(value) for name, value in limits.items()}),
        "geometry": geometry,
    }
    return RobotInfo(**{**msgspec.structs.asdict(info), **changed})


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


def pose_query(yaw: float, pitch: float, roll: float, *, relative: bool, speed: float | None) -> PoseQuery:
    """Return a query from angles (deg) and a speed (deg/s).

    Raises WrongUsage unless they are finite numbers and `relative` is a bool.
    """
    return PoseQuery(
        absolute=not true_or_false("relative", relative),
        yaw=to_rad("yaw", yaw),
        pitch=to_rad("pitch", pitch),
        roll=to_rad("roll", roll),
        speed=None if speed is None else to_rad("speed", speed, "degrees/s"),
    )


def motion_query(
    short: float, middle: float, long: float, *, relative: bool, speed: Speed | None
) -> MotionQuery:
    """Return a query from angles (deg), with one `speed` (deg/s) or one per arm; raises the errors of `pose_query`."""
    each = None if speed is None else Vector3(*[to_rad("speed", one, "degrees/s") for one in per_arm(speed)])
    position = Vector3(to_rad("short", short), to_rad("middle", middle), to_rad("long", long))
    return MotionQuery(absolute=not true_or_false("relative", relative), position=position, speed=each)


def per_arm(speed: Speed) -> Sequence[float]:
    """Return one speed per arm; raises WrongUsage unless `speed` is one number or three."""
    if not isinstance(speed, Sequence) or isinstance(speed, str):
        return (speed,) * 3
    if len(speed) != 3:
        raise wrong_usage(
            f"speed has {len(speed)} numbers: give one for all arms, or three: short, middle, long.",
        )
    return speed


def to_rad(what: str, angle: float, unit: str = "degrees") -> float:
    """Convert degrees or degrees/s to rad or rad/s; raises the errors of `checked_number`."""
    return math.radians(checked_number(what, angle, unit))


def checked_number(what: str, value: float, unit: str) -> float:
    """Return the value as a float; raise WrongUsage unless it is a finite number that fits into a message."""
    if not isinstance(value, Real) or isinstance(value, bool):
        raise wrong_usage(f"{what} is {value!r}: give a number of {unit}.")
    try:
        finite = float(value)
    except OverflowError:  # an integer of more than 308 digits
        finite = math.inf
    if not math.isfinite(finite):
        raise wrong_usage(f"{what} is {finite:g}: give a finite number of {unit}.")
    if not codec.fits(finite):
        raise wrong_usage(f"{what} is {finite:g}: numbers up to 3.4e38 are allowed.")
    return finite


def checked_place(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a place in m; raises the errors of `checked_number`."""
    return checked_number("x", x, "m"), checked_number("y", y, "m"), checked_number("z", z, "m")


def true_or_false(what: str, on: bool) -> bool:  # noqa: FBT001
    """Return `on`; raises WrongUsage unless it is a bool, because the text "no" would count as true."""
    if isinstance(on, bool):
        return on
    raise wrong_usage(f"{what} is {on!r}: give True or False.")


def checked_seconds(what: str, value: float, *, zero: bool = False) -> float:
    """Return a time in s; raises WrongUsage unless it is a number above 0, or with `zero` from 0, and at most a day."""
    if (
        isinstance(value, Real)
        and not isinstance(value, bool)
        and 0 <= float(value) <= DAY_S
        and (value or zero)
    ):
        return float(value)
    allowed = f"from 0 to {DAY_S:.0f}" if zero else f"above 0, at most {DAY_S:.0f}"
    raise wrong_usage(f"{what} is {value!r}: give a number of seconds {allowed}.")


def checked_factor(factor: float) -> float:
    """Return a speed factor; raises WrongUsage (BAD_VALUE) unless it is from SLOWEST to FASTEST."""
    if SLOWEST <= factor <= FASTEST:  # false for NaN
        return factor
    raise wrong_usage(
        f"The speed factor is {factor:g}: give a number from {SLOWEST:g} to {FASTEST:g}, for example 0.5.",
    )


def robot_of(info: RobotInfo) -> RobotData:
    """Return robot data with the limits and the geometry of this info."""
    return replace(ROBOT, geometry=info.geometry or ROBOT.geometry, limits=info.limits)


class Kinematics:
    """Inverse and forward kinematics of one robot; they need no connection. See `beatrix_zenoh.motion.kinematics`."""

    def __init__(self, info: RobotInfo) -> None:
        self.geometry: GeometryData = info.geometry or ROBOT.geometry
        """Geometry of the neck (deg)"""
        self.limits: LimitsData = info.limits
        """Limits of every motion (deg, deg/s, deg/s2); `inverse` and `forward` do not check them: see `Robot.preview`"""
        self._neck = Neck(self.geometry)

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
            BeatrixError: OUT_OF_REACH if the rods do not fit these arms; not Refused, because nothing was requested.
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
        raise wrong_usage(
            f"The place is {distance:.2f} m from the neck's centre, in or straight above the head: choose one further "
            "away, for example look_at(1, 0, 0.16).",
        )
    return math.degrees(math.atan2(y, x)), math.degrees(math.asin(EYE_UP_M / distance) - math.atan2(z, away))


@dataclass(frozen=True, repr=False)
class Preview(Suggesting):
    """What a motion would do; the robot has not moved."""

    duration: float
    """time until the arms rest (s)"""
    tilt_max: float
    """largest tilt of the head on the way (deg)"""
    gap_min: float
    """smallest gap between neighbouring arms on the way (deg)"""
    path: Path
    """times (s), arms and head (deg)"""

    def plot(self) -> Figure:
        """Return a figure of the path; raises WrongUsage without the extra `plot`."""
        return path_figure(self.path)

    def __repr__(self) -> str:
        return f"<preview: {self.duration:.1f} s, tilt up to {self.tilt_max:.1f}°, gap at least {self.gap_min:.1f}°>"


def path_figure(path: Path) -> Figure:
    """Return a figure of a previewed path: arms and head over time; raises the errors of `time_figure`."""
    arms, head = zip(*path.arms, strict=True), zip(*path.head, strict=True)
    return time_figure(path.t, dict(zip(ARMS, arms, strict=True)), dict(zip(AXES, head, strict=True)))


def preview_of(reply: PreviewReply) -> Preview:
    """Convert an accepted preview to degrees."""
    return Preview(
        reply.duration,
        math.degrees(reply.tilt_max),
        math.degrees(reply.gap_min),
        Path(reply.t, [arm_angles(arms) for arms in reply.arms], [head_angles(head) for head in reply.head]),
    )
