"""Relative motions count from the exact goal of the last motion, unless something else has moved the arms."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh import Refused
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Vector3
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Telemetry
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.planner import Goal, Planner

PLANNER = Planner(ROBOT)
STEP = math.tau / PLANNER.gear.steps_per_turn
HALF = STEP / 2 * (1 + 1e-6)
REST = (0, 0, 0)

Query = MotionQuery | PoseQuery


def single(degrees: float) -> float:
    """Return an angle in rad, as a message transports it."""
    (angle,) = struct.unpack("<f", struct.pack("<f", math.radians(degrees)))
    return float(angle)


def at(steps: tuple[int, int, int], velocity: tuple[int, int, int] = REST) -> Telemetry:
    return Telemetry(0, 1, 3, 0, 0, steps, velocity, 0, 0)


class Robot:
    """A robot whose arms arrive at each accepted goal at once."""

    def __init__(self) -> None:
        self.steps = REST
        self.last: Goal | None = None

    def carry_out(self, query: Query) -> Goal | None:
        """Move to the goal of a query and return it; None if it was refused."""
        try:
            goal = PLANNER.goal(query, at(self.steps), self.last)
        except Refused:
            return None
        self.last, self.steps = goal, goal.steps
        return goal

    @property
    def arms(self) -> Arms:
        return PLANNER.gear.to_rad(self.steps)


def turn(yaw: float, pitch: float = 0.0, roll: float = 0.0) -> PoseQuery:
    return PoseQuery(absolute=False, yaw=single(yaw), pitch=single(pitch), roll=single(roll))


def arms(short: float, middle: float, long: float) -> MotionQuery:
    return MotionQuery(absolute=False, position=Vector3(single(short), single(middle), single(long)))


angles = st.one_of(st.floats(-0.1, 0.1), st.floats(-3, 3))


@given(st.lists(st.tuples(angles, angles, angles), max_size=40))
@example([(0.05, 0.0, 0.0)] * 30)
@example([(0.04, 0.01, -0.04)] * 30)
def test_a_sequence_of_relative_poses_ends_at_the_arms_of_the_sum(steps: list[Arms]) -> None:
    robot, total = Robot(), [0.0, 0.0, 0.0]
    for step in steps:
        query = turn(*step)
        if robot.carry_out(query) is not None:
            total = [a + b for a, b in zip(total, (query.yaw, query.pitch, query.roll), strict=True)]
    assert robot.arms == pytest.approx(PLANNER.neck.inverse(*total), abs=HALF)


@pytest.mark.parametrize("query", [turn(0.03), arms(0.03, 0.03, 0.03)])
def test_if_the_arms_do_not_stand_at_the_goal_the_set_point_is_the_base(query: Query) -> None:
    """After STOP, a lost board or a motion of another kind; the parts of a microstep are then forgotten."""
    robot = Robot()
    robot.carry_out(turn(10.03))
    robot.steps = (50, 50, 50)
    goal = robot.carry_out(query)
    assert goal is not None
    assert goal.exact == pytest.approx((50 * STEP + math.radians(0.03),) * 3, abs=1e-6)


def test_while_a_motion_runs_a_relative_motion_counts_from_the_present_set_point() -> None:
    running = PLANNER.goal(turn(40), at(REST))
    goal = PLANNER.goal(turn(2), at((50, 50, 50), (200, 200, 200)), running)
    assert goal.exact == pytest.approx((50 * STEP + math.radians(2),) * 3, abs=1e-6)


@pytest.mark.parametrize("part", [0, 1, 2])
def test_a_held_button_turns_the_head_about_no_other_axis(part: int) -> None:
    """A stream of relative motions, each begun when a fifth of the last one is made."""
    last, steps = None, REST
    for _ in range(28):
        last = PLANNER.goal(turn(*(5.0 if i == part else 0.0 for i in range(3))), at(steps), last)
        steps = PLANNER.gear.to_steps(last.trajectory.at(last.duration / 5)[0])
    assert last is not None
    assert last.pose is not None
    assert [angle for i, angle in enumerate(last.pose) if i != part] == pytest.approx([0.0, 0.0], abs=1e-11)


def test_an_axis_that_the_last_motion_has_turned_stops_at_the_set_point() -> None:
    running = PLANNER.goal(turn(40), at(REST))
    goal = PLANNER.goal(turn(0, 2), at((50, 50, 50), (200, 200, 200)), running)
    assert goal.pose == pytest.approx((50 * STEP, math.radians(2), 0.0), abs=1e-6)


@pytest.mark.parametrize("query", [turn(0.04), arms(0.0, -0.04, 0.0)])
def test_a_relative_motion_of_less_than_half_a_microstep_turns_the_arms_with_the_next_one(
    query: Query,
) -> None:
    robot = Robot()
    first, again = robot.carry_out(query), robot.carry_out(query)
    assert first is not None
    assert again is not None
    assert (first.steps, first.turns, first.duration, again.turns) == (REST, False, 0.0, True)


def test_the_limits_are_checked_on_the_exact_sum() -> None:
    robot = Robot()
    robot.carry_out(PoseQuery(pitch=single(34.9)))
    tilts = []
    while (goal := robot.carry_out(turn(0.0, 0.04))) is not None:
        assert goal.pose is not None
        tilts.append(goal.pose[1])
    assert max(tilts) == pytest.approx(math.radians(35.05), abs=math.radians(0.06))
