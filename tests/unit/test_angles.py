"""What the SDK takes for an angle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beatrix_zenoh import BeatrixError
from beatrix_zenoh.names import check_name
from beatrix_zenoh.robot import motion_query, pose_query, to_rad


@pytest.mark.parametrize("angle", [90, 90.0, np.float32(90), np.float64(90), np.int64(90)])
def test_whatever_counts_is_taken(angle: float) -> None:
    assert to_rad("yaw", angle) == pytest.approx(math.pi / 2)


@pytest.mark.parametrize(
    ("angle", "told"),
    [
        ("20", "yaw is '20': give a number of degrees"),
        (None, "yaw is None: give a number of degrees"),
        ([1.0], "yaw is"),
        (math.nan, "yaw is nan: give a finite number of degrees"),
        (True, "yaw is True: give a number of degrees"),
        (10**400, "yaw is inf: give a finite number of degrees"),
        (1e300, "no message holds a number that large"),
    ],
)
def test_whatever_does_not_is_refused_by_name(angle: float, told: str) -> None:
    with pytest.raises(BeatrixError, match=told):
        to_rad("yaw", angle)


def test_speeds_are_told_in_their_unit() -> None:
    with pytest.raises(BeatrixError, match=r"speed is 'fast': give a number of degrees/s\."):
        pose_query(0, 0, 0, relative=False, speed="fast")  # type: ignore[arg-type]


def test_a_text_is_no_switch() -> None:
    with pytest.raises(BeatrixError, match=r"relative is 'no': give True or False\."):
        motion_query(0, 0, 0, relative="no", speed=None)  # type: ignore[arg-type]


def test_a_number_may_be_a_name() -> None:
    assert check_name(5) == "5"  # type: ignore[arg-type]
