"""Convert arguments of the SDK, in degrees, to queries; invalid arguments are rejected before sending."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real

from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason, Vector3
from beatrix_zenoh.contract.errors import WrongUsage

DAY_S = 86400.0
SLOWEST, FASTEST = 0.01, 100.0
"""Range of speed factors."""
Speed = float | Sequence[float]
"""Top speed in deg/s: one number for all arms, or three: short, middle, long."""


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
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"speed has {len(speed)} numbers: give one for all arms, or three: short, middle, long.",
        )
    return speed


def to_rad(what: str, angle: float, unit: str = "degrees") -> float:
    """Convert degrees or degrees/s to rad or rad/s; raises the errors of `checked_number`."""
    return math.radians(checked_number(what, angle, unit))


def checked_number(what: str, value: float, unit: str) -> float:
    """Return the value as a float; raise WrongUsage unless it is a finite number that fits into a message."""
    if not isinstance(value, Real) or isinstance(value, bool):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {value!r}: give a number of {unit}.")
    try:
        finite = float(value)
    except OverflowError:  # an integer of more than 308 digits
        finite = math.inf
    if not math.isfinite(finite):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {finite:g}: give a finite number of {unit}.")
    if not codec.fits(finite):
        raise WrongUsage(Reason.BAD_VALUE, f"{what} is {finite:g}: numbers up to 3.4e38 are allowed.")
    return finite


def true_or_false(what: str, on: bool) -> bool:  # noqa: FBT001
    """Return `on`; raises WrongUsage unless it is a bool, because the text "no" would count as true."""
    if isinstance(on, bool):
        return on
    raise WrongUsage(Reason.BAD_VALUE, f"{what} is {on!r}: give True or False.")


def checked_seconds(what: str, value: float) -> float:
    """Return a timeout in s; raises WrongUsage unless it is a number above 0 and at most a day."""
    if isinstance(value, Real) and not isinstance(value, bool) and 0 < float(value) <= DAY_S:
        return float(value)
    raise WrongUsage(
        Reason.BAD_VALUE, f"{what} is {value!r}: give a number of seconds above 0, at most {DAY_S:.0f}."
    )


def checked_wait(what: str, value: float) -> float:
    """Return a time to wait in s; raises WrongUsage unless it is a number from 0 to a day."""
    if isinstance(value, Real) and not isinstance(value, bool) and 0 <= float(value) <= DAY_S:
        return float(value)
    raise WrongUsage(
        Reason.BAD_VALUE, f"{what} is {value!r}: give a number of seconds from 0 to {DAY_S:.0f}."
    )


def checked_factor(factor: float) -> float:
    """Return a speed factor; raises WrongUsage (BAD_VALUE) unless it is from SLOWEST to FASTEST."""
    if SLOWEST <= factor <= FASTEST:  # false for NaN
        return factor
    raise WrongUsage(
        Reason.BAD_VALUE,
        f"The speed factor is {factor:g}: give a number from {SLOWEST:g} to {FASTEST:g}, for example 0.5.",
    )
