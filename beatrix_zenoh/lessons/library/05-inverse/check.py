"""Check of lesson 5."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import leaning

POSES = 50
TILT_DEG, YAW_DEG = 34.0, 60.0
CLOSURE, INVERSE_DEG, FORWARD_DEG = 1e-6, 0.01, 0.001
SHOWN = ((20, 10, 0), (-30, 0, 15), (0, 20, 0), (40, -10, -10), (-15, 15, 20), (0, -20, 5))
"""The poses of start.py: yaw, pitch, roll (deg)."""
SHOWN_DEG = 0.5
"""The solution is within 0.17 deg: microsteps, and the weight of the head."""


def poses() -> list[tuple[float, float, float]]:
    """Return yaw, pitch and roll (deg) of poses that the robot allows, always the same."""
    draw = np.random.default_rng(5)
    found = []
    for yaw, tilt, way in draw.uniform((-1, 0, 0), (1, 1, 360), (POSES, 3)):
        pitch, roll = leaning(math.radians(TILT_DEG * tilt), math.radians(way))
        found.append((YAW_DEG * yaw, math.degrees(pitch), math.degrees(roll)))
    return found


def true_closures(arms: list[float], head: list[float]) -> list[float]:
    """Return the three closures for any arms and head (deg)."""
    yaw, pitch, roll = np.radians(head)
    about_z = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    about_y = np.array([[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    found = []
    for azimuth, arm in zip((90.0, 210.0, 330.0), arms, strict=True):
        a, m = math.radians(azimuth + arm), math.radians(azimuth + 90)
        elbow = math.sqrt(0.5) * np.array([math.cos(a), math.sin(a), -1])
        found.append(float(elbow @ about_z @ about_y @ about_x @ [math.cos(m), math.sin(m), 0]))
    return found


def listed(numbers: Iterable[float], places: int = 1) -> str:
    """Return numbers as a pupil reads them."""
    return ", ".join(f"{number:.{places}f}" for number in numbers)


def check(attempt: Attempt) -> None:
    """Compare closures, inverse and forward with the robot's own, then look where the head of the robot rests."""
    for arms, head in (([10, -20, 30], [0, 0, 0]), ([0, 0, 0], [25, 15, -10]), ([40, 10, -5], [-20, 5, 30])):
        said, true = attempt.call_array("closures", arms, head, shape=(3,)), true_closures(arms, head)
        slips.numbers("closures", said, true, CLOSURE)
        off = float(np.abs(np.subtract(said, true)).max())
        attempt.require(
            "closures", off <= CLOSURE, arms=arms, head=head, said=listed(said, 4), true=listed(true, 4)
        )
    neck = Neck()
    for pose in poses():
        true_arms = np.degrees(neck.inverse(*np.radians(pose)))
        said = attempt.call_array("inverse", *pose, shape=(3,))
        attempt.require("number", bool(np.isfinite(said).all()), function="inverse", given=listed(pose))
        slips.numbers("inverse", said, true_arms, INVERSE_DEG)
        off = said - true_arms
        wrapped = (off + 180) % 360 - 180
        near = np.abs(wrapped).max() <= INVERSE_DEG
        attempt.require(
            "inverse", bool(near), pose=listed(pose), said=listed(said, 2), true=listed(true_arms, 2)
        )
        attempt.require(
            "wrapped", bool(np.abs(off).max() < 180), pose=listed(pose), off=float(np.abs(off).max())
        )
    for pose in poses():
        true_arms = [math.degrees(arm) for arm in neck.inverse(*np.radians(pose))]
        said = attempt.call_array("forward", *true_arms, shape=(3,))
        attempt.require("number", bool(np.isfinite(said).all()), function="forward", given=listed(true_arms))
        slips.numbers("forward", said, pose, FORWARD_DEG)
        off = np.abs(said - pose).max()
        attempt.require("forward", bool(off <= FORWARD_DEG), arms=listed(true_arms), off=float(off))
    seen = attempt.observe()
    head = np.column_stack([seen.yaw, seen.pitch, seen.roll])
    still = np.r_[False, np.abs(np.diff(head, axis=0)).max(axis=1) < 0.02]
    for pose in SHOWN:
        off = np.abs(head[still] - pose).max(axis=1).min(initial=999.0)
        attempt.require("shown", bool(off <= SHOWN_DEG), pose=pose, off=float(off))
