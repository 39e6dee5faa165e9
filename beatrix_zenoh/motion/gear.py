"""Conversion between motor microsteps and arm angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh.contract._generated.robot import ROBOT, DriveData

_SINGLE: Final = 0.005
"""Quarter microsteps per second, added before rounding down: single precision may have made a whole number smaller."""

Arms = tuple[float, float, float]
"""Angles (rad) or rates (rad/s) of the short, middle and long arm."""


class Gear:
    """Conversion between microsteps of the motors and radians of the arms."""

    def __init__(self, drive: DriveData = ROBOT.drive) -> None:
        self.steps_per_turn = drive.full_steps * drive.microsteps * drive.gear_ring / drive.gear_pinion
        """Microsteps of one arm turn; not an integer."""
        self._steps_per_rad = tuple(sign * self.steps_per_turn / math.tau for sign in drive.sign)

    def to_steps(self, arms: Sequence[float]) -> tuple[int, int, int]:
        """Return the microsteps nearest to these arm angles (rad)."""
        (x, y, z), (a, b, c) = arms, self._steps_per_rad
        return round(x * a), round(y * b), round(z * c)

    def to_rad(self, steps: Sequence[float]) -> Arms:
        """Convert microsteps to arm angles (rad), or microsteps per second to rad/s."""
        (x, y, z), (a, b, c) = steps, self._steps_per_rad
        return x / a, y / b, z / c

    def speed_to_quarters(self, speeds: Sequence[float]) -> tuple[int, int, int]:
        """Convert speeds (rad/s) to quarter microsteps per second, the unit of MOVE; rounded down, at least 1."""
        (x, y, z), (a, b, c) = speeds, self._steps_per_rad
        return _quarters(x * a), _quarters(y * b), _quarters(z * c)

    def quarters_to_speed(self, quarters: Sequence[int]) -> Arms:
        """Convert quarter microsteps per second, the unit of MOVE, to speeds (rad/s)."""
        x, y, z = self.to_rad(quarters)
        return abs(x) / 4, abs(y) / 4, abs(z) / 4


def _quarters(speed: float) -> int:
    """Convert microsteps per second to quarters; rounded down, at least 1."""
    return max(1, int(4 * abs(speed) + _SINGLE))
