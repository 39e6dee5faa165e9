"""Motor microsteps and arm angles: the only place where one becomes the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh._generated.robot import ROBOT, Drive

_SINGLE: Final = 0.005
"""Of a quarter microstep per second: speeds travel in single precision, and a whole number of quarters must stay one."""

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
        x, y, z = (round(angle * scale) for angle, scale in zip(arms, self._steps_per_rad, strict=True))
        return x, y, z

    def to_rad(self, steps: Sequence[float]) -> Arms:
        """Arm angles in rad of microsteps (or rad/s of microsteps per second)."""
        x, y, z = (count / scale for count, scale in zip(steps, self._steps_per_rad, strict=True))
        return x, y, z

    def speed_to_quarters(self, speeds: Sequence[float]) -> tuple[int, int, int]:
        """Speeds in rad/s as quarter microsteps per second, the unit of MOVE: no faster, but at least 1."""
        x, y, z = (
            max(1, int(4 * abs(speed * scale) + _SINGLE))
            for speed, scale in zip(speeds, self._steps_per_rad, strict=True)
        )
        return x, y, z

    def quarters_to_speed(self, quarters: Sequence[int]) -> Arms:
        """What MOVE's speeds are in rad/s."""
        x, y, z = self.to_rad([count / 4 for count in quarters])
        return abs(x), abs(y), abs(z)
