"""Check of lesson 3."""

from __future__ import annotations

import math

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.motion.kinematics import Neck

SETS = ((10, 0, 0), (0, 10, 0), (0, 0, 10), (8, 8, 8), (0, -8, 8), (8, 8, 0))
"""Arms (deg) at which the linear rule is within 0.32 deg of the head."""
NEAR_DEG = 1.0
NOD_DEG = 12.0
STRAIGHT_DEG = 2.0
"""The nod of the linear rule yaws by 0.2 deg and rolls by 0.6 deg."""


def head(arms: tuple[float, float, float]) -> list[float]:
    """Return yaw, pitch and roll (deg) of the head."""
    return [math.degrees(angle) for angle in Neck().forward([math.radians(arm) for arm in arms])]


def check(attempt: Attempt) -> None:
    """Compare the rule with the kinematics, then look for a pure nod in the positions of the head."""
    said = [attempt.call_array("rule", *arms, shape=(3,)) for arms in SETS]
    for axis, figure in enumerate(("yaw", "pitch", "roll")):
        numbers = [angles[axis] for angles in said]
        slips.numbers(f"rule, {figure}", numbers, [head(arms)[axis] for arms in SETS], NEAR_DEG)
        for arms, angles in zip(SETS, said, strict=True):
            true = head(arms)[axis]
            attempt.require(
                figure, abs(angles[axis] - true) <= NEAR_DEG, arms=arms, said=angles[axis], true=true
            )
    short, middle, long = attempt.call_array("arms_for_nod", NOD_DEG, shape=(3,)).tolist()
    yaw, pitch, roll = head((short, middle, long))
    arms = f"{short:g}, {middle:g}, {long:g}"
    values = {"arms": arms, "yaw": yaw, "pitch": pitch, "roll": roll}
    attempt.require("nod", abs(yaw) <= STRAIGHT_DEG, **values)
    attempt.require("leans", abs(roll) <= STRAIGHT_DEG, **values)
    slips.numbers(f"arms_for_nod({NOD_DEG:g}), pitch", pitch, NOD_DEG, STRAIGHT_DEG)
    attempt.require("size", abs(pitch - NOD_DEG) <= STRAIGHT_DEG, arms=arms, pitch=pitch)
    seen = attempt.observe()
    pure = (abs(seen.yaw) <= STRAIGHT_DEG) & (abs(seen.roll) <= STRAIGHT_DEG)
    largest = float(seen.pitch[pure].max(initial=0.0))
    attempt.require("shown", largest >= NOD_DEG - STRAIGHT_DEG, largest=largest)
