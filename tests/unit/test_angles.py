"""Checks of angles, speeds, names and timeouts in the SDK."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beatrix_zenoh import BeatrixError, Robot
from beatrix_zenoh.client.degrees import Speed, motion_query, to_rad
from beatrix_zenoh.contract.errors import WrongUsage


@pytest.mark.parametrize("angle", [90, 90.0, np.float32(90), np.float64(90), np.int64(90)])
def test_finite_numbers_are_accepted(angle: float) -> None:
    assert to_rad("yaw", angle) == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(
    ("angle", "message"),
    [
        ("20", "yaw is '20': give a number of degrees"),
        (None, "yaw is None: give a number of degrees"),
        ([1.0], "yaw is"),
        (math.nan, "yaw is nan: give a finite number of degrees"),
        (True, "yaw is True: give a number of degrees"),
        (10**400, "yaw is inf: give a finite number of degrees"),
        (1e300, "numbers up to 3.4e38 are allowed"),
    ],
)
def test_invalid_values_are_refused_with_the_name_of_the_angle(angle: float, message: str) -> None:
    with pytest.raises(BeatrixError, match=message):
        to_rad("yaw", angle)


def test_each_arm_may_have_its_own_speed() -> None:
    for speed in ((10, 20, 30), [10.0, 20.0, 30.0]):
        query = motion_query(0, 0, 0, relative=False, speed=speed)
        assert query.speed is not None
        assert (query.speed.x, query.speed.z) == (math.radians(10), math.radians(30))
    alike = motion_query(0, 0, 0, relative=False, speed=10)
    assert alike.speed is not None
    assert alike.speed.x == alike.speed.z == math.radians(10)


@pytest.mark.parametrize(
    ("speed", "message"),
    [
        ((10, 20), "speed has 2 numbers: give one for all arms, or three"),
        ((10, 20, "fast"), "speed is 'fast': give a number of degrees/s"),
        ("fast", "speed is 'fast'"),
        ((), "speed has 0 numbers"),
    ],
)
def test_invalid_speeds_are_refused(speed: Speed, message: str) -> None:
    with pytest.raises(WrongUsage, match=message):
        motion_query(0, 0, 0, relative=False, speed=speed)


@pytest.mark.parametrize("value", [-1, 0, None, "2", True, math.nan, math.inf, 1e9])
def test_a_timeout_that_is_not_a_number_above_0_is_refused(value: float) -> None:
    with pytest.raises(WrongUsage, match=r"timeout_s is .*: give a number of seconds above 0"):
        Robot("bea", "hw", timeout_s=value)
