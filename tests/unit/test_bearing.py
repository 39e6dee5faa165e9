"""The direction in which the eyes look at a place."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.client.degrees import EYE_UP_M, bearing
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion.rotation import rotation_of


@given(x=st.floats(-2, 2), y=st.floats(-2, 2), z=st.floats(-0.6, 1.1))
def test_the_place_is_straight_ahead_of_the_eyes(x: float, y: float, z: float) -> None:
    if math.hypot(x, y) < 0.35:
        return
    yaw, pitch = bearing(x, y, z)
    rows = rotation_of(math.radians(yaw), math.radians(pitch), 0.0)
    ahead, left, up = (
        sum(row[i] * place for row, place in zip(rows, (x, y, z), strict=True)) for i in range(3)
    )
    assert ahead > 0
    assert (left, up) == pytest.approx((0.0, EYE_UP_M), abs=1e-9)


@pytest.mark.parametrize("place", [(0.05, 0.0, 0.1), (0.0, 0.0, 1.0)])
def test_a_place_in_or_above_the_head_is_rejected(place: tuple[float, float, float]) -> None:
    with pytest.raises(WrongUsage, match="choose one further away"):
        bearing(*place)
