"""The control law of a simulation that follows: from a set point of the hardware to the next motion. No I/O.

The firmware brakes before its target, so a target at the hardware's place would be reached late: at 60 deg/s the arms
brake over the last 10 deg. The target is therefore the place at which the hardware would rest if it braked now, and the
speed is that of the hardware, corrected in proportion to the distance between the two.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from beatrix_zenoh.motion.gear import Arms

GAIN: Final = 10.0
"""Correction of the speed per distance (1/s)."""
AHEAD_S: Final = 0.1
"""Time (s) by which a target is ahead of an arm that does not brake, so that the simulation does not brake before the
next set point arrives: five periods of publication, because on a busy computer some arrive late."""
LAG_S: Final = 0.02
"""Intended lag (s) behind the received set points. The simulation hears of a brake up to a period of publication late;
without a lag it would overshoot meanwhile."""
SLOWEST: Final = math.radians(1.0)
"""Lowest speed (rad/s) of an arm, which is also that of an arm that has to wait for the hardware."""
AT_REST: Final = math.radians(0.2)
"""An arm below this velocity (rad/s) rests."""
SETTLING: Final = math.radians(20.0)
"""Lowest speed (rad/s) towards the place of a hardware that rests."""


class SetPoint(NamedTuple):
    """Set points (rad) of the arms and their velocities (rad/s)."""

    place: Arms
    velocity: Arms


class Course(NamedTuple):
    """Targets (rad) of the arms, and their top speeds (rad/s)."""

    target: Arms
    speed: Arms


def resting_place(point: SetPoint, acceleration: float) -> Arms:
    """Return the places (rad) at which the arms would rest if they braked now with this acceleration (rad/s2)."""
    (x, y, z), (u, v, w) = point.place, point.velocity
    braked = 2 * acceleration
    return x + u * abs(u) / braked, y + v * abs(v) / braked, z + w * abs(w) / braked


def advanced(point: SetPoint, by_s: float) -> SetPoint:
    """Return the set points after `by_s` (s) at constant velocity."""
    (x, y, z), (u, v, w) = point.place, point.velocity
    return SetPoint((x + u * by_s, y + v * by_s, z + w * by_s), point.velocity)


def distance(one: Arms, other: Arms) -> float:
    """Return the largest distance (rad) between the same arms."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


def course_to(
    hardware: SetPoint,
    before: Arms,
    own: SetPoint,
    *,
    acceleration: float,
    speed_max: float,
    ahead_s: float = AHEAD_S,
) -> Course:
    """Return the motion that keeps the simulation at the hardware.

    Args:
        hardware: its set points now.
        before: its velocities (rad/s) in the previous sample.
        own: set points of the simulation now.
        acceleration: of an arm (rad/s2).
        speed_max: largest speed of an arm (rad/s).
        ahead_s: time by which targets are ahead (s).
    """
    rest = resting_place(hardware, acceleration)
    behind = advanced(hardware, -LAG_S).place
    target, speed = [], []
    for i in range(3):
        velocity, away = hardware.velocity[i], behind[i] - own.place[i]
        if abs(velocity) < AT_REST:
            target.append(hardware.place[i])
            speed.append(min(speed_max, max(SETTLING, GAIN * abs(away))))
            continue
        brakes = abs(velocity) < abs(before[i])
        end = rest[i] + (0.0 if brakes else velocity * ahead_s)
        towards = math.copysign(1.0, end - own.place[i])
        target.append(end)
        speed.append(min(speed_max, max(SLOWEST, (velocity + GAIN * away) * towards)))
    return Course((target[0], target[1], target[2]), (speed[0], speed[1], speed[2]))
