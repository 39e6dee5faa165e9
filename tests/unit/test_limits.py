"""Checks of motions against the limits over their whole path."""

from __future__ import annotations

import math
import time
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from beatrix_zenoh.contract._generated.messages import Alternative, Detail, Limit, Reason, Vector3
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData, RobotData
from beatrix_zenoh.contract._generated.robot import LimitsData as LimitData
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.motion.limits.region import border, reach
from beatrix_zenoh.motion.trajectory import Trajectory

NECK = Neck()
LIMITS = MotionLimits()
CLOSE_ARMS = MotionLimits(RobotData(limits=LimitData(gap_min=60.0)))
"""Limits of a robot for which the arm gap is the tightest one."""
REST: Arms = (0.0, 0.0, 0.0)
SPEED: Arms = (1.0, 1.0, 1.0)


def arms_at(*degrees: float) -> Arms:
    x, y, z = (math.radians(value) for value in degrees)
    return x, y, z


def pose(yaw: float, pitch: float, roll: float) -> Arms:
    """Return the arms (rad) of a pose in degrees."""
    return NECK.inverse(*(math.radians(value) for value in (yaw, pitch, roll)))


def allowed(
    target: Arms,
    *,
    start: Arms = REST,
    velocity: Arms = REST,
    speed: Arms = SPEED,
    straight: bool = False,
    limits: MotionLimits = LIMITS,
) -> Trajectory:
    return limits.check_motion(start, velocity, target, speed, straight=straight)


def refused(target: Arms, **how: Any) -> tuple[Reason, Detail]:
    """Assert that a motion is refused, and return why."""
    with pytest.raises(Refused) as caught:
        allowed(target, **how)
    assert caught.value.detail is not None
    return caught.value.reason, caught.value.detail


def alternative_of(detail: Detail) -> Alternative:
    assert detail.alternative is not None
    return detail.alternative


def astuple(vector: Vector3 | None) -> Arms:
    assert vector is not None
    return vector.x, vector.y, vector.z


REASONS = {Limit.TILT: Reason.OUT_OF_REACH, Limit.ARM_GAP: Reason.ARM_GAP, Limit.YAW: Reason.YAW_LIMIT}


@pytest.mark.parametrize(
    ("target", "limit", "arms", "value", "low", "high"),
    [
        (arms_at(60, 0, 0), Limit.TILT, [], 35.6, None, 35.0),
        (arms_at(100, 0, 0), Limit.ARM_GAP, ["short", "middle"], 20.0, 30.0, None),
        (arms_at(0, 0, -100), Limit.ARM_GAP, ["middle", "long"], 20.0, 30.0, None),
        (arms_at(-100, 0, 0), Limit.ARM_GAP, ["long", "short"], 20.0, 30.0, None),
        (arms_at(185, 185, 185), Limit.YAW, [], 185.0, -180.0, 180.0),
        (arms_at(-185, -185, -185), Limit.YAW, [], -185.0, -180.0, 180.0),
    ],
)
@pytest.mark.parametrize("straight", [True, False])
def test_a_goal_beyond_a_limit_is_refused_with_limit_and_value(
    target: Arms,
    limit: Limit,
    arms: list[str],
    value: float,
    low: float | None,
    high: float | None,
    straight: bool,
) -> None:
    reason, detail = refused(target, straight=straight)
    assert reason == REASONS[limit]
    assert (detail.limit, detail.arms, detail.unit, detail.at_goal) == (limit, arms, "rad", True)
    assert math.degrees(detail.value or 0.0) == pytest.approx(value, abs=0.05)
    for bound, wanted in ((detail.low, low), (detail.high, high)):
        assert (None if bound is None else round(math.degrees(bound), 6)) == wanted
    assert (detail.leaves_s or 0) > 0
    with pytest.raises(Refused):
        LIMITS.check_pose(astuple(detail.leaves_arms))


def test_a_refusal_of_arms_beyond_every_pose_names_the_furthest_position() -> None:
    reason, detail = refused(arms_at(400, 370, 365))
    assert (reason, detail.limit, detail.arms) == (Reason.YAW_LIMIT, Limit.TRAVEL, ["short"])
    allowed(astuple(alternative_of(detail).arms))


def test_a_path_that_leaves_the_limits_between_two_allowed_poses_is_refused() -> None:
    """The head tilts too far between these poses if the arms arrive one after another."""
    start, target = pose(0, 30, 0), pose(0, -15, 30)
    slow: Arms = (1.5, 0.05, 1.5)
    LIMITS.check_pose(start)
    LIMITS.check_pose(target)
    reason, detail = refused(target, start=start, speed=slow)
    assert (reason, detail.limit, detail.at_goal) == (Reason.OUT_OF_REACH, Limit.TILT, False)
    allowed(target, start=start, speed=astuple(alternative_of(detail).speed))
    allowed(target, start=start, speed=slow, straight=True)


@pytest.mark.parametrize(
    ("limits", "start", "towards", "further", "reason"),
    [
        (LIMITS, pose(0, 38, 0), [pose(0, 0, 0), pose(0, 37, 0), pose(20, 20, 0), pose(0, -34, 0)],
         [pose(0, 38.5, 0), pose(0, -38, 0), pose(0, 41, 0)], Reason.OUT_OF_REACH),
        (LIMITS, arms_at(400, 400, 400), [arms_at(390, 390, 390), REST], [arms_at(401, 401, 401)], Reason.YAW_LIMIT),
        (CLOSE_ARMS, pose(0, 34, 0), [REST], [pose(0, 34.8, 0)], Reason.ARM_GAP),
    ],
    ids=["tilt", "yaw", "gap"],
)  # fmt: skip
def test_a_start_beyond_a_limit_may_be_left_and_not_made_worse(
    limits: MotionLimits, start: Arms, towards: list[Arms], further: list[Arms], reason: Reason
) -> None:
    with pytest.raises(Refused):
        limits.check_pose(start)
    for target in towards:
        allowed(target, start=start, straight=True, limits=limits)
    for target in further:
        assert refused(target, start=start, straight=True, limits=limits)[0] == reason


def test_arms_that_have_separated_may_not_close_up_again() -> None:
    # The arms are 59.2 deg apart, too close; with this velocity they reach 60.04 deg, which is allowed, and return.
    start = pose(0, 32.9, 0)
    assert math.radians(59) < NECK.gaps(start)[0] < CLOSE_ARMS.gap_min
    allowed(pose(0, 32, 0), start=start, velocity=(-0.22, 0.22, 0.0), limits=CLOSE_ARMS)
    reason, _ = refused(start, start=start, velocity=(-0.22, 0.22, 0.0), limits=CLOSE_ARMS)
    assert reason == Reason.ARM_GAP


def test_a_limit_may_be_exceeded_by_half_the_tolerance() -> None:
    allowed(arms_at(180.04, 180.04, 180.04), start=pose(179, 0, 0))
    assert refused(arms_at(180.07, 180.07, 180.07), start=pose(179, 0, 0))[0] == Reason.YAW_LIMIT


def test_a_goal_is_refused_for_a_limit_that_it_exceeds() -> None:
    """Unequal speeds tilt the head too far on the path, but the goal exceeds only the yaw limit."""
    _, detail = refused(pose(190, 30, 0), speed=(1.5, 0.5, 1.0))
    assert (detail.limit, detail.at_goal) == (Limit.YAW, True)
    assert math.degrees(detail.value or 0.0) == pytest.approx(190.0)


def test_the_refusal_of_arms_that_fit_no_orientation_of_the_head_explains_what_to_do() -> None:
    with pytest.raises(Refused, match="calibrate") as caught:
        allowed(REST, start=arms_at(170, -170, 20))
    assert caught.value.reason is Reason.OUT_OF_REACH
    assert caught.value.detail is not None
    assert caught.value.detail.leaves_s == 0


@pytest.mark.parametrize("value", [1e6, -1e6, 1e300, math.nan, math.inf, -math.inf])
def test_extreme_numbers_are_refused_within_a_second(value: float) -> None:
    began = time.process_time()
    for place in range(3):
        x, y, z = (value if i == place else 0.0 for i in range(3))
        extreme = (x, y, z)
        ways: list[dict[str, Any]] = [
            {"target": extreme},
            {"target": (value, value, value)},
            {"target": REST, "start": extreme},
            {"target": REST, "velocity": extreme, "straight": True},
            {"target": REST, "speed": extreme},
        ]
        for way in ways:
            with pytest.raises(Refused):
                allowed(**way)
    assert time.process_time() - began < 1.0


def test_the_speed_limit_itself_is_accepted() -> None:
    LIMITS.check_speed([LIMITS.speed_max] * 3)
    LIMITS.check_speed([1.5707964] * 3)  # 90 deg/s as float32
    LIMITS.check_speed([LIMITS.default_speed] * 3)


def test_a_neck_that_cannot_reach_its_tilt_limit_is_refused() -> None:
    with pytest.raises(Refused, match=r"'tilt_max' is 35\.0°; with these rods at most 29\.0°"):
        MotionLimits(RobotData(geometry=GeometryData(rod_twist=80, mount_angle=85)))


# -- the border of the orientations in which the head may rest agrees with the limits of the node --


NARROW = replace(ROBOT, limits=replace(ROBOT.limits, gap_min=60.0))
NEAR = math.radians(0.3)
"""Between two directions the border is a chord, and the node tolerates 0.1 deg."""
BOTH = {"as built": MotionLimits(ROBOT), "narrow": MotionLimits(NARROW)}


@pytest.mark.parametrize("name", BOTH)
@given(
    yaw=st.floats(-2.9, 2.9),
    direction=st.floats(-math.pi, math.pi),
    share=st.floats(0.0, 1.5, exclude_min=True),
)
def test_inside_the_border_a_pose_is_allowed_and_outside_it_is_refused(
    name: str, yaw: float, direction: float, share: float
) -> None:
    limits = BOTH[name]
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
