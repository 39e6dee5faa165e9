"""The orientations in which a head may rest, as a border in the plane of pitch and roll."""

from __future__ import annotations

import math
from functools import cache
from typing import Final

from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import tilt_of

DIRECTIONS: Final = 72
"""Number of directions of a border."""
STEP: Final = math.radians(1.0)
HALVINGS: Final = 16


@cache
def border(tilt_max: float, gap_min: float, geometry: GeometryData = ROBOT.geometry) -> tuple[float, ...]:
    """Return how far the head may lean in each direction, as lengths of the vector (roll, pitch), in rad.

    Direction k is at k / DIRECTIONS of a turn from roll (right ear down) towards pitch (nose down). The border does not
    depend on yaw, because turning all arms by one angle changes neither a gap nor the tilt.

    Args:
        tilt_max: largest tilt (rad).
        gap_min: smallest gap between neighbouring arms (rad).
        geometry: the neck.
    """
    neck = Neck(geometry)

    def allowed(reach: float, direction: float) -> bool:
        pitch, roll = reach * math.sin(direction), reach * math.cos(direction)
        if tilt_of(pitch, roll) > tilt_max:
            return False
        try:
            return min(neck.gaps(neck.inverse(0.0, pitch, roll))) >= gap_min
        except Refused:
            return False

    def furthest(direction: float) -> float:
        low, high = 0.0, STEP
        while allowed(high, direction):
            low, high = high, high + STEP
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if allowed(middle, direction) else (low, middle)
        return low

    return tuple(furthest(math.tau * k / DIRECTIONS) for k in range(DIRECTIONS))


def reach(limits: tuple[float, ...], pitch: float, roll: float) -> float:
    """Return how far the head may lean in the direction of a pitch and roll, in the unit of the border `limits`."""
    turn = math.atan2(pitch, roll) / math.tau * len(limits) % len(limits)
    first = int(turn) % len(limits)
    share = turn - int(turn)
    return limits[first] * (1 - share) + limits[(first + 1) % len(limits)] * share
