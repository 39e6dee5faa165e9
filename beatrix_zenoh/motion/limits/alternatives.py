"""Search for accepted alternatives to a refused request.

Every candidate is rounded to tenths of a degree, as users type it, and to the precision of messages, so a client that
follows the advice sends exactly the values that were checked.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import Final

from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import leaning, tilt_of

_GRID_DEG: Final = 0.1
_TRIES: Final = 5
_ROUNDING: Final = 1e-6


def furthest(start: Arms, goal: Arms, accepts: Callable[[Arms], bool]) -> Arms | None:
    """Return the furthest accepted point found on the line from `start` to `goal` (rad), None if there is none.

    accepts: whether a request for this point would be accepted.
    """
    low, high, share = 0.0, 1.0, 1.0
    found: Arms | None = None
    for _ in range(_TRIES):
        if share * math.dist(start, goal) < math.radians(_GRID_DEG):
            break
        x, y, z = (a + share * (b - a) for a, b in zip(start, goal, strict=True))
        candidate = typed((x, y, z))
        if accepts(candidate):
            low, found = share, candidate
        else:
            high = share
        if low == 1.0:
            break
        share = (low + high) / 2
    if found is None or _distance(found, start) < math.radians(_GRID_DEG) * 0.99:
        return None
    return found


def typed(angles: Arms) -> Arms:
    """Round angles (rad) to tenths of a degree and to the precision of messages."""
    x, y, z = (round(math.degrees(angle) / _GRID_DEG) * _GRID_DEG for angle in angles)
    return in_single((math.radians(x), math.radians(y), math.radians(z)))


def in_single(values: Arms) -> Arms:
    """Round the values to single precision, the precision of messages."""
    x, y, z = struct.unpack("<3f", struct.pack("<3f", *values))
    return x, y, z


def typed_speed(speed: float, low: float, high: float) -> float:
    """Return `speed` (rad/s), at least `low` and at most `high`, rounded to few digits in degrees per second."""
    if speed >= high:
        return math.radians(_rounded(math.degrees(high), up=False))
    rate = _rounded(max(math.degrees(speed), 0.0), up=False)
    return math.radians(max(rate, _rounded(math.degrees(low), up=True)))


def nearest_pose(pose: Arms, tilt_max: float, yaw_max: float) -> Arms:
    """Return the allowed head orientation (rad) nearest to `pose`: less yaw, and less tilt in the same direction."""
    yaw, pitch, roll = pose
    if tilt_of(pitch, roll) > tilt_max:
        # Beyond a right angle the head would lean to the other side of what was asked for.
        pitch, roll = (max(-math.pi / 2, min(math.pi / 2, angle)) for angle in (pitch, roll))
        direction = math.atan2(math.cos(pitch) * math.sin(roll), math.sin(pitch))
        pitch, roll = (_toward_zero(angle) for angle in leaning(tilt_max, direction))
    return max(-yaw_max, min(yaw_max, yaw)), pitch, roll


def _toward_zero(angle: float) -> float:
    tenths = math.degrees(angle) / _GRID_DEG
    return math.radians(math.trunc(tenths + math.copysign(_ROUNDING, tenths)) * _GRID_DEG)


def _rounded(number: float, *, up: bool) -> float:
    """Round a non-negative number to tenths, or to two significant digits if it is less than one."""
    if not number:
        return 0.0
    scale = 10.0 ** max(1, 1 - math.floor(math.log10(number * (1 + _ROUNDING))))
    return (math.ceil(number * scale - _ROUNDING) if up else math.floor(number * scale + _ROUNDING)) / scale


def _distance(one: Arms, other: Arms) -> float:
    return max(abs(a - b) for a, b in zip(one, other, strict=True))
