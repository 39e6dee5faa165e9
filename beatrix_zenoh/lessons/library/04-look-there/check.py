"""Check of lesson 4."""

from __future__ import annotations

import math

import numpy as np

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt

EYE_FORWARD_M, EYE_UP_M = 0.107, 0.144
PLACES = (
    (1.0, 0.4, 0.16),
    (0.9, -0.5, 0.3),
    (0.5, 1.0, 0.1),
    (-0.3, 1.2, 0.2),
    (0.8, 0.6, 0.5),
    (0.84, -0.18, -0.15),
)
"""Places (m) of the function's check; at (0.8, 0.6) x differs from the distance, one is behind the robot."""
PERSON = (0.85, -0.6, 0.35)
"""Place (m) of the person of the observed check."""
YAW_DEG, PITCH_DEG = 1.0, 2.0
"""The solution's pitch is within 0.6 deg of the exact one, because the eyes turn about the neck."""
MISS_DEG = 3.0
HELD = 15
"""Positions in a row, 50 in a second; the check observes for 0.4 s after the end of the program."""


def bearing(x: float, y: float, z: float) -> tuple[float, float]:
    """Return the exact yaw and pitch (deg): the eyes' height above the neck stays, the neck turns."""
    away = math.hypot(x, y)
    pitch = math.asin(EYE_UP_M / math.hypot(away, z)) - math.atan2(z, away)
    return math.degrees(math.atan2(y, x)), math.degrees(pitch)


def miss(yaw: np.ndarray, pitch: np.ndarray) -> np.ndarray:
    """Return the angles (deg) between the direction of view, from between the eyes, and the person; roll is 0."""
    x, y, z = PERSON
    turn, nod = np.radians(yaw), np.radians(pitch)
    along, left = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    ahead, up = along * np.cos(nod) - z * np.sin(nod), along * np.sin(nod) + z * np.cos(nod)
    away = np.hypot(left, up - EYE_UP_M)
    return np.degrees(np.arctan2(away, ahead - EYE_FORWARD_M))


def check(attempt: Attempt) -> None:
    """Compare the bearing of six places with the exact one, then look where the head of the robot rests."""
    said = [attempt.call_array("bearing", *place, shape=(2,)) for place in PLACES]
    turned = all(
        abs(second - bearing(*place)[0]) <= YAW_DEG and abs(first - bearing(*place)[1]) <= PITCH_DEG
        for place, (first, second) in zip(PLACES, said, strict=True)
    )
    attempt.require("order", not turned)
    for axis, (figure, near) in enumerate((("yaw", YAW_DEG), ("pitch", PITCH_DEG))):
        numbers = [angles[axis] for angles in said]
        slips.numbers(f"bearing, {figure}", numbers, [bearing(*place)[axis] for place in PLACES], near)
        for (x, y, z), angles in zip(PLACES, said, strict=True):
            true = bearing(x, y, z)[axis]
            attempt.require(
                figure, abs(angles[axis] - true) <= near, x=x, y=y, z=z, said=angles[axis], true=true
            )
    seen = attempt.observe(target=PERSON)
    missed = miss(seen.yaw, seen.pitch)
    longest = max(len(run) for run in "".join("x" if near else " " for near in missed <= MISS_DEG).split(" "))
    attempt.require("held", longest >= HELD, last=float(missed[-1]))
