"""The verdict on a motion, and for a no: what breaks which limit where, and what would be accepted instead."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.drive import Arms
from beatrix_zenoh.errors import BeatrixError, Refused
from beatrix_zenoh.kinematics import Neck
from beatrix_zenoh.limits.walk import GAP, TILT, Breach, Limit, Walker
from beatrix_zenoh.rotation import tilt_of
from beatrix_zenoh.trajectory import Trajectory, plan

_SAMPLES: Final = 24
_TRIES: Final = 5
_SEEN: Final = math.radians(0.05)
"""Smallest angle that a tenth of a degree shows."""
_PAIRS: Final = ("short and middle", "middle and long", "long and short")


@dataclass(frozen=True, slots=True)
class Asked:
    """A motion as asked: rad, rad/s."""

    start: Arms
    velocity: Arms
    target: Arms
    speed: Arms
    straight: bool

    def trajectory(self, acceleration: float) -> Trajectory:
        """How the firmware would carry it out."""
        return plan(self.start, self.velocity, self.target, self.speed, acceleration, straight=self.straight)

    def shortened(self, fraction: float) -> Asked:
        """The first part of it."""
        x, y, z = (a + fraction * (b - a) for a, b in zip(self.start, self.target, strict=True))
        return replace(self, target=(x, y, z))

    def in_proportion(self) -> Asked:
        """The same with speeds that let the arms arrive at about the same time."""
        ways = [abs(b - a) for a, b in zip(self.start, self.target, strict=True)]
        longest = max(*ways, 1e-9)
        x, y, z = (min(self.speed) * max(0.01, way / longest) for way in ways)
        return replace(self, speed=(x, y, z))


class Judge:
    """Says yes or why not."""

    def __init__(self, neck: Neck, walker: Walker, limit: Limit, acceleration: float) -> None:
        self._neck, self._walker, self._limit, self._acceleration = neck, walker, limit, acceleration
        self._arm_max = limit.yaw_max + math.pi

    def sane(self, arms: Sequence[float], start: Sequence[float] = (0.0, 0.0, 0.0)) -> None:
        """Raise Refused if the arms (rad) are no numbers, or too far for any pose (and further than the start).

        Every arm of an allowed pose is within half a turn of the head's yaw.
        """
        if not all(math.isfinite(angle) for angle in arms):
            raise Refused(Reason.BAD_VALUE, f"Arms {listed(arms)} rad: every angle must be a finite number.")
        furthest = max(abs(angle) for angle in arms)
        if furthest > max(self._arm_max, *(abs(angle) for angle in start)):
            raise Refused(
                Reason.YAW_LIMIT,
                f"Arms at {degrees(arms)} deg: the head may turn to yaw +-{math.degrees(self._limit.yaw_max):.1f} deg, "
                f"and no arm gets further than {math.degrees(self._arm_max):.1f} deg with it.",
            )

    def pose(self, arms: Sequence[float]) -> None:
        """Raise Refused if the head must not rest with the arms (rad) there."""
        index = self._broken(arms)
        if index is not None:
            raise Refused(_reason(index), f"There {self._says(index, arms)}; {self._allowed(index)}.")

    def walk(self, trajectory: Trajectory) -> Breach | None:
        """As `Walker.walk`, but raises Refused if no head fits the start."""
        try:
            return self._walker.walk(trajectory)
        except BeatrixError as error:
            raise Refused(error.reason, error.message) from error

    def refusal(self, breach: Breach, asked: Asked) -> Refused:
        """What to raise for a motion that breaks a limit."""
        trajectory = asked.trajectory(self._acceleration)
        goal = self._broken(asked.target)
        # a goal with crowded arms usually tilts too far first, but the arms are what was asked
        index = goal if goal is not None and goal >= GAP else breach.index
        where = f"{breach.t:.2f} s after the start with the arms at {degrees(breach.arms)} deg"
        if goal is None:
            worst = max(self._after(breach, trajectory), key=lambda arms: self._badness(index, arms))
            text = f"The goal is allowed, but on the way {self._says(index, worst)}; {self._allowed(index)}"
        else:
            text = f"At the goal {self._says(index, asked.target)}; {self._allowed(index)}"
        return Refused(
            _reason(index), f"{text}. The way leaves the limits {where}. {self._instead(breach, asked, goal)}"
        )

    def _instead(self, breach: Breach, asked: Asked, goal: int | None) -> str:
        """What would be accepted; tried, not guessed."""
        if goal is None and not asked.straight:
            together = asked.in_proportion()
            if self._accepts(together):
                return f"With speeds of {degrees(together.speed)} deg/s, in proportion to the ways, it would be accepted."
        way = math.dist(asked.start, asked.target)
        low, high = 0, 100
        guess = min(99, int(100 * math.dist(asked.start, breach.arms) / way) - 1) if way else 0
        for _ in range(_TRIES):
            if guess <= low:
                break
            if self._accepts(asked.shortened(guess / 100)):
                low = guess
            else:
                high = guess
            guess = (low + high) // 2
        if not low:
            return "No part of this motion would be accepted from here."
        target = asked.shortened(low / 100).target
        return f"The first {low} % of it, to arms at {degrees(target)} deg, would be accepted."

    def _accepts(self, asked: Asked) -> bool:
        return self.walk(asked.trajectory(self._acceleration)) is None

    def _after(self, breach: Breach, trajectory: Trajectory) -> list[Arms]:
        span = trajectory.duration - breach.t
        return [trajectory.at(breach.t + span * i / _SAMPLES)[0] for i in range(_SAMPLES + 1)]

    def _broken(self, arms: Sequence[float]) -> int | None:
        """Index of a limit that a head resting there breaks; a gap before all others, for arms are what people see."""
        x, y, z = arms
        broken = self._walker.beyond((x, y, z))
        return max(broken, default=None)

    def _value(self, index: int, arms: Sequence[float]) -> float | None:
        """Tilt, yaw or gap (rad); None if no head fits the arms."""
        if index >= GAP:
            return self._neck.gaps(arms)[index - GAP]
        try:
            yaw, pitch, roll = self._neck.forward(arms)
        except BeatrixError:
            return None
        return tilt_of(pitch, roll) if index == TILT else yaw

    def _badness(self, index: int, arms: Sequence[float]) -> float:
        value = self._value(index, arms)
        if value is None:
            return math.inf
        return -value if index >= GAP else abs(value)

    def _says(self, index: int, arms: Sequence[float]) -> str:
        value = self._value(index, arms)
        if value is None:
            return f"no head fits the arms, at {degrees(arms)} deg"
        angle = f"{math.degrees(value):z.1f} deg"
        if index == TILT:
            return f"the head would tilt {angle}"
        if index >= GAP:
            pair = f"the {_PAIRS[index - GAP]} arms would"
            apart = value > -_SEEN
            return f"{pair} be {angle} apart" if apart else f"{pair} have passed each other"
        return f"the head would turn to yaw {angle}"

    def _allowed(self, index: int) -> str:
        if index == TILT:
            return f"it may tilt up to {math.degrees(self._limit.tilt_max):.1f} deg"
        if index >= GAP:
            return f"they must keep {math.degrees(self._limit.gap_min):.1f} deg"
        return f"its cables allow +-{math.degrees(self._limit.yaw_max):.1f} deg"


def _reason(index: int) -> Reason:
    if index == TILT:
        return Reason.OUT_OF_REACH
    return Reason.ARM_GAP if index >= GAP else Reason.YAW_LIMIT


def listed(values: Sequence[float]) -> str:
    """Numbers for people."""
    return ", ".join(f"{value:g}" for value in values)


def degrees(angles: Sequence[float]) -> str:
    """Angles (rad) as degrees for people."""
    return ", ".join(f"{math.degrees(angle):z.1f}" for angle in angles)
