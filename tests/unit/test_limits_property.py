"""Properties of the limits: accepted motions keep them everywhere, refused motions exceed them somewhere."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import LimitsData as LimitData
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.motion.limits.path_check import TOLERANCE
from beatrix_zenoh.motion.rotation import leaning, tilt_of
from beatrix_zenoh.motion.trajectory import Trajectory
from beatrix_zenoh.motion.trajectory import plan as time_law

# Counting coverage triples the time of these tests; test_limits.py covers the same code.
pytestmark = pytest.mark.no_cover

NECK = Neck()
LIMITS = MotionLimits()
CLOSE_ARMS = MotionLimits(RobotData(limits=LimitData(gap_min=60.0)))
"""Limits of a robot for which the arm gap is the tightest one."""
REST: Arms = (0.0, 0.0, 0.0)
SPEED: Arms = (1.0, 1.0, 1.0)


def dense(way: Trajectory, count: int = 200) -> Iterator[Arms]:
    return (way.at(way.duration * i / count)[0] for i in range(count + 1))


directions = st.floats(-math.pi, math.pi)


@st.composite
def poses(draw: st.DrawFn, tilt_max: float = 35.0) -> Arms:
    tilt = math.radians(draw(st.floats(0, tilt_max)))
    return NECK.inverse(draw(directions), *leaning(tilt, draw(directions)))


rates = st.tuples(*[st.floats(-1.5, 1.5)] * 3)
speeds = st.tuples(*[st.floats(0.1, 1.5)] * 3)


@given(
    poses(),
    rates | st.just(REST),
    poses(40) | st.tuples(*[st.floats(-4, 4)] * 3),
    speeds,
    st.booleans(),
    st.sampled_from([LIMITS, CLOSE_ARMS]),
)
def test_accepted_paths_keep_the_limits_and_refused_paths_do_not(
    start: Arms, velocity: Arms, target: Arms, speed: Arms, straight: bool, limits: MotionLimits
) -> None:
    assume(min(NECK.gaps(start)) > limits.gap_min)
    check(limits, start, velocity, target, speed, straight)


@given(
    poses(),
    st.tuples(*[st.floats(-0.15, 0.15)] * 3),
    st.tuples(*[st.floats(-0.3, 0.3)] * 3) | st.just(REST),
    st.tuples(*[st.floats(-0.15, 0.15)] * 3),
    st.sampled_from([LIMITS, CLOSE_ARMS]),
)
def test_paths_near_the_last_one_keep_the_limits_or_are_refused(
    last: Arms, away: Arms, velocity: Arms, way: Arms, limits: MotionLimits
) -> None:
    start = (last[0] + away[0], last[1] + away[1], last[2] + away[2])
    assume(min(NECK.gaps(last)) > limits.gap_min and not limits._checker.exceeded(start))
    limits.check_motion(last, REST, last, SPEED, straight=False)
    target = (start[0] + way[0], start[1] + way[1], start[2] + way[2])
    check(limits, start, velocity, target, SPEED, straight=False)


def check(
    limits: MotionLimits, start: Arms, velocity: Arms, target: Arms, speed: Arms, straight: bool
) -> None:
    """Assert on the densely sampled path that an accepted motion keeps all limits, and a refused one exceeds its limit."""
    try:
        ways = list(dense(limits.check_motion(start, velocity, target, speed, straight=straight)))
    except Refused as refusal:
        trajectory = time_law(start, velocity, target, speed, limits.acceleration, straight=straight)
        assert any(breaks_at(limits, refusal.reason, arms) for arms in dense(trajectory, 2000))  # noqa: PT017
        return
    heads = [NECK.forward(arms) for arms in ways]
    assert max(tilt_of(pitch, roll) for _, pitch, roll in heads) <= limits.tilt_max + TOLERANCE
    assert max(abs(yaw) for yaw, _, _ in heads) <= limits.yaw_max + TOLERANCE
    assert min(min(NECK.gaps(arms)) for arms in ways) >= limits.gap_min - TOLERANCE


def breaks_at(limits: MotionLimits, reason: Reason, arms: Arms) -> bool:
    if reason == Reason.ARM_GAP:
        return min(NECK.gaps(arms)) < limits.gap_min
    try:
        yaw, pitch, roll = NECK.forward(arms)
    except BeatrixError:
        return True
    return abs(yaw) > limits.yaw_max if reason == Reason.YAW_LIMIT else tilt_of(pitch, roll) > limits.tilt_max


@given(poses())
def test_poses_read_back_from_steps_are_accepted(target: Arms) -> None:
    gear = Gear()
    position = gear.to_rad(gear.to_steps(target))
    LIMITS.check_motion(position, REST, position, SPEED, straight=True)
    LIMITS.check_motion(position, REST, target, SPEED, straight=True)


def test_the_bound_of_curvature_holds_everywhere_within_the_limits() -> None:
    """Compare Taylor's bound, on which the check is based, with the function itself."""
    checker = LIMITS._checker
    up_bend, yaw_bend = checker._curvature[0], checker._curvature[1]
    counts = {0.1: 0, 0.2: 0, 0.4: 0, 0.8: 0}
    for i in range(1200):
        reach = list(counts)[i % 4]
        share, direction, turn = math.sqrt((i * 0.618034) % 1), i * 2.399963, i * 0.754877
        arms = NECK.inverse(0, *leaning(share * math.radians(35), direction))
        c, s = reach * math.cos(turn), reach * math.sin(turn)
        step = (
            c / math.sqrt(2) + s / math.sqrt(6),
            -c / math.sqrt(2) + s / math.sqrt(6),
            -2 * s / math.sqrt(6),
        )
        start_head = NECK.head(arms)
        try:
            moved = NECK.head((arms[0] + step[0], arms[1] + step[1], arms[2] + step[2]))
        except BeatrixError:  # no head orientation fits arms that far
            continue
        up = sum(a * b for a, b in zip(start_head.up_by_arm, step, strict=True))
        yaw = sum(a * b for a, b in zip(start_head.yaw_by_arm, step, strict=True))
        if moved.up >= math.cos(math.radians(37)):
            counts[reach] += 1
            assert abs(moved.up - start_head.up - up) <= up_bend / 2 * reach**2
            assert abs(moved.yaw - start_head.yaw - yaw) <= yaw_bend / 2 * reach**2
    assert min(counts.values()) > 90
