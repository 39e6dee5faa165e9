"""A planned motion to be checked."""

from __future__ import annotations

from dataclasses import dataclass, replace

from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.trajectory import Trajectory, plan

_LEAST_SHARE = 0.01
"""Lowest speed of an arm that hardly moves, as a share of the speed of the arm with the longest distance."""


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """Start, velocity at the start, goal and top speeds of a motion, in rad and rad/s.

    `straight` has the meaning of the argument of `trajectory.plan`.
    """

    start: Arms
    velocity: Arms
    target: Arms
    speed: Arms
    straight: bool

    def trajectory(self, acceleration: float) -> Trajectory:
        """Return the trajectory that the firmware would follow with this acceleration (rad/s2)."""
        return plan(self.start, self.velocity, self.target, self.speed, acceleration, straight=self.straight)

    def to(self, target: Arms) -> PlannedMotion:
        """Return the same motion with another goal (rad)."""
        return replace(self, target=target)

    def at_speed(self, speed: Arms) -> PlannedMotion:
        """Return the same motion at other speeds (rad/s)."""
        return replace(self, speed=speed)

    def proportional_speed(self) -> Arms:
        """Return speeds (rad/s) with which the arms arrive at about the same time; no arm becomes faster."""
        travel = [abs(b - a) for a, b in zip(self.start, self.target, strict=True)]
        longest = max(*travel, 1e-9)
        x, y, z = (min(self.speed) * max(_LEAST_SHARE, way / longest) for way in travel)
        return x, y, z
