"""Conversion between motor microsteps and arm angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh._generated.robot import ROBOT, Drive

_SINGLE: Final = 0.005
"""Tolerance in quarters of a microstep per second: a whole number must survive single precision."""

Arms = tuple[float, float, float]
"""Angles (rad) or rates (rad/s) of the short, middle and long arm."""


class Gear:
    """Conversion between microsteps of the motors and radians of the arms."""

    def __init__(self, drive: Drive = ROBOT.drive) -> None:
        self.steps_per_turn = drive.full_steps * drive.microsteps * drive.gear_ring / drive.gear_pinion
        """Microsteps of one arm turn; not an integer."""
        self._steps_per_rad = tuple(sign * self.steps_per_turn / math.tau for sign in drive.sign)

    def to_steps(self, arms: Sequence[float]) -> tuple[int, int, int]:
        """Nearest microsteps of arm angles in rad."""
        (x, y, z), (a, b, c) = arms, self._steps_per_rad
        return round(x * a), round(y * b), round(z * c)

    def to_rad(self, steps: Sequence[float]) -> Arms:
        """Arm angles in rad of microsteps (or rad/s of microsteps per second)."""
        (x, y, z), (a, b, c) = steps, self._steps_per_rad
        return x / a, y / b, z / c

    def speed_to_quarters(self, speeds: Sequence[float]) -> tuple[int, int, int]:
        """Speeds in rad/s as quarter microsteps per second, the unit of MOVE: no faster, but at least 1."""
        (x, y, z), (a, b, c) = speeds, self._steps_per_rad
        return _quarters(x * a), _quarters(y * b), _quarters(z * c)

    def quarters_to_speed(self, quarters: Sequence[int]) -> Arms:
        """Speeds of MOVE in rad/s."""
        x, y, z = self.to_rad(quarters)
        return abs(x) / 4, abs(y) / 4, abs(z) / 4


def _quarters(speed: float) -> int:
    """Microsteps per second as quarters, no faster, but at least 1."""
    return max(1, int(4 * abs(speed) + _SINGLE))
