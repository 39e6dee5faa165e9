"""Goals of the planner: target, speed and kind of frame."""

from __future__ import annotations

import math

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason, Vector3
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.planner import Planner

PLANNER = Planner(ROBOT)
FURTHEST_STEPS = 2**15 - 1
"""Largest step count of a frame."""
HERE = (0.2, 0.1, -0.15)
"""Yaw, pitch and roll (rad) of the head before a relative motion."""
STEP = math.tau / PLANNER.gear.steps_per_turn


def at(arms: Arms = (0.0, 0.0, 0.0)) -> Telemetry:
    """Return telemetry of a board whose arms rest at these angles (rad)."""
    return Telemetry(0, 1, 3, 0, 0, PLANNER.gear.to_steps(arms), (0, 0, 0), 0, 0)


@pytest.mark.parametrize("by", [(0.07, 0.0, 0.0), (0.0, -0.07, 0.0), (0.0, 0.0, 0.07), (0.05, -0.06, 0.07)])
def test_a_relative_pose_adds_to_each_angle(by: Arms) -> None:
    query = PoseQuery(absolute=False, yaw=by[0], pitch=by[1], roll=by[2])
    goal = PLANNER.goal(query, at(PLANNER.neck.inverse(*HERE)))
    expected = [here + more for here, more in zip(HERE, by, strict=True)]
    assert PLANNER.neck.forward(goal.target) == pytest.approx(expected, abs=3 * STEP)


def test_an_absolute_pose_does_not_depend_on_the_present_one() -> None:
    goal = PLANNER.goal(PoseQuery(yaw=0.1, pitch=-0.1, roll=0.05), at(PLANNER.neck.inverse(*HERE)))
    assert PLANNER.neck.forward(goal.target) == pytest.approx((0.1, -0.1, 0.05), abs=3 * STEP)


def test_a_relative_motion_adds_to_each_arm() -> None:
    query = MotionQuery(absolute=False, position=Vector3(0.1, -0.05, 0.02))
    goal = PLANNER.goal(query, at((0.1, 0.2, 0.3)))
    assert goal.target == pytest.approx((0.2, 0.15, 0.32), abs=STEP)


def test_the_target_is_the_angle_of_the_whole_steps_of_the_frame() -> None:
    goal = PLANNER.goal(MotionQuery(position=Vector3(0.1, 0.2, 0.3)), at())
    assert goal.steps == PLANNER.gear.to_steps((0.1, 0.2, 0.3))
    assert goal.target == PLANNER.gear.to_rad(goal.steps)
    assert goal.duration == goal.trajectory.duration > 0


@pytest.mark.parametrize("query", [PoseQuery(yaw=0.1), MotionQuery(position=Vector3(0.1, 0.1, 0.1))])
def test_without_a_speed_the_default_is_used(query: PoseQuery | MotionQuery) -> None:
    default = math.radians(ROBOT.limits.speed_default)
    assert PLANNER.goal(query, at()).quarters == PLANNER.gear.speed_to_quarters((default,) * 3)


def test_each_arm_has_its_own_speed() -> None:
    query = MotionQuery(position=Vector3(0.1, 0.1, 0.1), speed=Vector3(0.2, 0.3, 0.4))
    quarters = PLANNER.gear.speed_to_quarters((0.2, 0.3, 0.4))
    assert PLANNER.goal(query, at()).frame(9) == Move(9, PLANNER.gear.to_steps((0.1, 0.1, 0.1)), quarters)


def test_a_pose_is_a_straight_move_at_the_speed_of_the_fastest_arm() -> None:
    goal = PLANNER.goal(PoseQuery(yaw=0.1, speed=0.4), at())
    (quarters, *_) = PLANNER.gear.speed_to_quarters((0.4, 0.4, 0.4))
    assert goal.frame(9) == MoveStraight(9, PLANNER.gear.to_steps((0.1, 0.1, 0.1)), quarters)


@pytest.mark.parametrize(("speed", "reason"), [(0.9, Reason.SPEED_LIMIT), (1.0, None)])
def test_the_slowest_speed_is_a_quarter_of_a_microstep_per_second(
    speed: float, reason: Reason | None
) -> None:
    slowest = PLANNER.gear.quarters_to_speed((1, 1, 1))[0]
    query = PoseQuery(yaw=STEP, speed=speed * slowest)
    if reason is None:
        assert PLANNER.goal(query, at()).quarters == (1, 1, 1)
        return
    with pytest.raises(Refused, match="too low") as refusal:
        PLANNER.goal(query, at())
    assert refusal.value.reason is reason


@pytest.mark.parametrize("speed", [0.0, -0.5, 1000.0])
def test_an_impossible_speed_is_refused_and_not_rounded(speed: float) -> None:
    with pytest.raises(Refused) as refusal:
        PLANNER.goal(PoseQuery(yaw=0.1, speed=speed), at())
    assert refusal.value.reason is Reason.SPEED_LIMIT


def test_the_largest_step_count_of_a_frame_is_allowed() -> None:
    here = Telemetry(0, 1, 3, 0, 0, (FURTHEST_STEPS,) * 3, (0, 0, 0), 0, 0)
    stay = MotionQuery(absolute=False, position=Vector3(0.0, 0.0, 0.0))
    goal = PLANNER.goal(stay, here)
    assert goal.steps == (2**15 - 1,) * 3
    assert Move.unpack(goal.frame(1).pack()) == goal.frame(1)
    with pytest.raises(Refused, match="can be sent to the board"):
        PLANNER.goal(stay, here._replace(position=(FURTHEST_STEPS + 1,) * 3))


@pytest.mark.parametrize("axis", [1, 2])
def test_the_largest_tilt_is_allowed(axis: int) -> None:
    tilt = math.radians(ROBOT.limits.tilt_max)
    PLANNER.goal(tilted(axis, tilt), at())
    with pytest.raises(Refused, match="tilt") as refusal:
        PLANNER.goal(tilted(axis, tilt + math.radians(0.3)), at())
    assert refusal.value.reason is Reason.OUT_OF_REACH


def tilted(axis: int, tilt: float) -> PoseQuery:
    """Return a query for a head that is pitched (axis 1) or rolled (axis 2) by `tilt` (rad)."""
    return PoseQuery(pitch=tilt) if axis == 1 else PoseQuery(roll=tilt)
