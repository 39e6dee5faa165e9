"""Check of lesson 6."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from beatrix_zenoh.contract._generated.messages import EventKind, Phase, Reason
from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.measures import largest_tilt
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import leaning

PITCHES = (20.0, 35.0, 44.0)
RATIO = 0.02
ROBOT_FILE = Path(__file__).with_name("files") / "wide.toml"
TILT_MAX_DEG, GAP_MIN_DEG = 43.0, 30.0
"""Limits of the robot in wide.toml."""
DIRECTIONS = (30, 90, 150, 210, 270, 330)
SHORT_OF_DEG = 1.5
"""The solution stops 0.5 to 0.75 deg before the edge."""
BESIDE_DEG = 5.0


def ratio(pitch: float) -> float:
    """Return the largest derivative of an arm by the pitch (deg)."""
    neck, small = Neck(), 1e-6
    p = math.radians(pitch)
    before, after = neck.inverse(0.0, p - small, 0.0), neck.inverse(0.0, p + small, 0.0)
    return max(abs(b - a) for a, b in zip(before, after, strict=True)) / (2 * small)


def edge(direction: float) -> float:
    """Return the largest tilt (deg) that the limits allow in a direction (deg)."""
    neck = Neck()
    for tilt in np.arange(0.0, TILT_MAX_DEG, 0.05):
        arms = neck.inverse(0.0, *leaning(math.radians(tilt), math.radians(direction)))
        if math.degrees(min(neck.gaps(arms))) < GAP_MIN_DEG:
            return float(tilt)
    return TILT_MAX_DEG


def check(attempt: Attempt) -> None:
    """Compare the speeds with the derivatives, then look how far the head of a wide robot leans, without refusals."""
    for pitch in PITCHES:
        said, true = attempt.call("speed_ratio", pitch), ratio(pitch)
        slips.numbers("speed_ratio", said, true, RATIO)
        attempt.require("ratio", abs(said / true - 1) <= RATIO, pitch=pitch, said=said, true=true)
    seen = attempt.observe(robot_file=ROBOT_FILE)
    refused = sum(
        event.count
        for event in seen.events
        if event.kind is EventKind.MOTION and event.phase is Phase.ACCEPTED and event.reason is not Reason.OK
    )
    attempt.require("refused_motions", refused == 0, count=refused)
    for direction in DIRECTIONS:
        tilt, true = largest_tilt(seen, direction, BESIDE_DEG), edge(direction)
        attempt.require("reached", tilt >= true - SHORT_OF_DEG, direction=direction, tilt=tilt, true=true)
