"""The border of the orientations in which the head may rest agrees with the limits of the node."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.motion.limits.region import border, reach

NARROW = replace(ROBOT, limits=replace(ROBOT.limits, gap_min=60.0))
NEAR = math.radians(0.3)
"""Between two directions the border is a chord, and the node tolerates 0.1 deg."""
LIMITS = {"as built": MotionLimits(ROBOT), "narrow": MotionLimits(NARROW)}


@pytest.mark.parametrize("name", LIMITS)
@given(
    yaw=st.floats(-2.9, 2.9),
    direction=st.floats(-math.pi, math.pi),
    share=st.floats(0.0, 1.5, exclude_min=True),
)
def test_inside_the_border_a_pose_is_allowed_and_outside_it_is_refused(
    name: str, yaw: float, direction: float, share: float
) -> None:
    limits = LIMITS[name]
    pitch, roll = math.sin(direction), math.cos(direction)
    furthest = reach(border(limits.tilt_max, limits.gap_min), pitch, roll)
    lean = furthest * share
    if abs(lean - furthest) < NEAR:
        return
    try:
        limits.check_pose(limits.arms_of_head(yaw, lean * pitch, lean * roll))
        allowed = True
    except Refused:
        allowed = False
    assert allowed is (lean < furthest)
