from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.robot import DriveData
from sim_node.plant import StepperDrive

CYCLE = math.radians(4 * 1.8 * 26 / 68)
"""Four full steps of 1.8 deg at the motor, as an angle of the arm."""
HOME = (0.0, 0.0, 0.0)

counts = st.tuples(*[st.integers(-(2**31), 2**31 - 1)] * 3)
angles = st.tuples(*[st.floats(-20.0, 20.0)] * 3)


def driven() -> StepperDrive:
    """Return a drive with its motors on, at home."""
    drive = StepperDrive()
    drive.step((0, 0, 0), HOME, on=True)
    return drive


def test_the_sign_reverses_a_motor() -> None:
    drive = StepperDrive(DriveData(sign=(-1, 1, 1)))
    drive.step((8, 8, 8), HOME, on=True)
    short, middle, long = drive.set_points
    assert short == -middle
    assert middle == long > 0


@given(counts, angles)
def test_set_points_differ_from_the_arm_by_at_most_half_a_cycle(
    pulses: tuple[int, int, int], arms: tuple[float, float, float]
) -> None:
    drive = driven()
    drive.step(pulses, arms, on=True)
    assert all(
        abs(arm - set_point) <= CYCLE / 2 + 1e-7
        for arm, set_point in zip(arms, drive.set_points, strict=True)
    )
    assert all(steps % 4 == 0 for steps in drive.slipped)


def test_motors_that_are_switched_on_lock_to_the_nearest_position_without_slip() -> None:
    drive = driven()
    sagged = (5.2 * CYCLE, -3.4 * CYCLE, 0.1 * CYCLE)
    drive.step((0, 0, 0), sagged, on=False)
    drive.step((0, 0, 0), sagged, on=True)
    assert drive.set_points == pytest.approx((5 * CYCLE, -3 * CYCLE, 0.0))
    assert drive.slipped == (0, 0, 0)
