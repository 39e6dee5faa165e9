"""Inverse and forward kinematics: closure, round trips, turns, refusals."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import GeometryData
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import dot, leaning, rotation_of

ANGLES = ((45, 90, 90), (54, 90, 90), (45, 80, 85), (45, 95, 100), (60, 90, 90))
NECKS = [
    Neck(
        GeometryData(
            arm_angle=a, rod_twist=r, mount_angle=m, hand=hand, arm_spacing=spacing, arm0_azimuth=azimuth
        )
    )
    for (a, r, m), hand, (spacing, azimuth) in itertools.product(ANGLES, (1, -1), ((120, 90), (-120, -70)))
]
SHIPPED = Neck()

necks = st.sampled_from(NECKS)
directions = st.floats(-math.pi, math.pi)
shares = st.floats(0, 1)


def reachable(neck: Neck, share: float) -> float:
    """Return a share of the largest tilt (rad): 40 deg, or 0.5 deg less than the reach if that is smaller."""
    return share * min(math.radians(40), neck.reach - math.radians(0.5))


@pytest.mark.no_cover
@given(necks, st.floats(-40, 40), shares, directions)
def test_inverse_closes_all_three_loops(neck: Neck, yaw: float, share: float, direction: float) -> None:
    pitch, roll = leaning(reachable(neck, share), direction)
    arms = neck.inverse(yaw, pitch, roll)
    geometry = neck.geometry
    alpha1, alpha2, beta = (
        math.radians(x) for x in (geometry.arm_angle, geometry.rod_twist, geometry.mount_angle)
    )
    cosine = (math.cos(alpha2) + math.cos(alpha1) * math.cos(beta)) / (math.sin(alpha1) * math.sin(beta))
    rotation = rotation_of(yaw, pitch, roll)
    for i, arm in enumerate(arms):
        azimuth = math.radians(geometry.arm0_azimuth + i * geometry.arm_spacing)
        elbow = (
            math.sin(alpha1) * math.cos(azimuth + arm),
            math.sin(alpha1) * math.sin(azimuth + arm),
            -math.cos(alpha1),
        )
        at = azimuth + geometry.hand * math.acos(cosine)
        home = (math.sin(beta) * math.cos(at), math.sin(beta) * math.sin(at), math.cos(beta))
        x, y, z = (dot(row, home) for row in rotation)
        assert dot(elbow, (x, y, z)) == pytest.approx(math.cos(alpha2), abs=1e-9)


@pytest.mark.no_cover
@given(necks, st.floats(-40, 40), shares, directions)
def test_forward_undoes_inverse(neck: Neck, yaw: float, share: float, direction: float) -> None:
    pitch, roll = leaning(reachable(neck, share), direction)
    assert neck.forward(neck.inverse(yaw, pitch, roll)) == pytest.approx((yaw, pitch, roll), abs=1e-9)


def failure(neck: Neck, arms: Arms) -> BeatrixError | None:
    """Return the error of the forward solution; None if there is none."""
    try:
        neck.forward(arms)
    except BeatrixError as error:
        return error
    return None


@given(st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 3))
def test_forward_returns_or_refuses_for_any_arms(arms: Arms) -> None:
    error = failure(SHIPPED, arms)
    assert error is None or error.reason in {Reason.OUT_OF_REACH, Reason.BAD_VALUE}


@pytest.mark.no_cover
@given(necks, st.tuples(*[st.floats(-math.pi, math.pi)] * 3))
def test_forward_finds_the_home_assembly_or_refuses(neck: Neck, arms: Arms) -> None:
    error = failure(neck, arms)
    if error is None:
        assert neck.in_home_assembly(arms, neck.rotation(arms))
    else:
        assert error.reason == Reason.OUT_OF_REACH
        assert "calibrate" in error.message


@pytest.mark.no_cover
@given(necks, shares, directions, directions)
def test_rotation_agrees_with_the_angles(neck: Neck, share: float, direction: float, yaw: float) -> None:
    arms = neck.inverse(yaw, *leaning(reachable(neck, share), direction))
    for row, expected in zip(neck.rotation(arms), rotation_of(*neck.forward(arms)), strict=True):
        assert row == pytest.approx(expected, abs=1e-9)


@pytest.mark.no_cover
@given(necks, shares, directions)
def test_derivatives_agree_with_differences(neck: Neck, share: float, direction: float) -> None:
    arms = neck.inverse(0.3, *leaning(reachable(neck, 0.9 * share), direction))
    head = neck.head(arms)
    assert sum(head.yaw_by_arm) == pytest.approx(1)
    assert sum(head.up_by_arm) == pytest.approx(0, abs=1e-9)
    for i in range(3):
        ahead = neck.head(tuple3([arm + 1e-5 * (j == i) for j, arm in enumerate(arms)]))
        behind = neck.head(tuple3([arm - 1e-5 * (j == i) for j, arm in enumerate(arms)]))
        assert head.yaw_by_arm[i] == pytest.approx((ahead.yaw - behind.yaw) / 2e-5, abs=1e-6)
        assert head.up_by_arm[i] == pytest.approx((ahead.up - behind.up) / 2e-5, abs=1e-6)


def tuple3(values: list[float]) -> Arms:
    x, y, z = values
    return x, y, z


def test_the_refusal_of_a_pose_out_of_reach_names_the_reach() -> None:
    with pytest.raises(Refused, match=r"would lean 50\.0°; at most 45\.0°") as caught:
        SHIPPED.inverse(0, math.radians(50), 0)
    assert caught.value.reason == Reason.OUT_OF_REACH


@pytest.mark.parametrize(
    "geometry",
    [
        GeometryData(rod_twist=20),
        GeometryData(mount_angle=0),
        GeometryData(hand=2),
        GeometryData(arm_angle=0),
        GeometryData(arm_spacing=0),
        GeometryData(arm_spacing=180),
    ],
)
def test_an_impossible_geometry_is_refused(geometry: GeometryData) -> None:
    with pytest.raises(Refused) as caught:
        Neck(geometry)
    assert caught.value.reason == Reason.BAD_VALUE
