"""From a question to a MOVE: what no frame can say is refused in words."""

from __future__ import annotations

import math
import struct

import pytest

from beatrix_zenoh import Refused
from beatrix_zenoh._generated.messages import MotionQuery, PoseQuery, Reason, Vector3
from beatrix_zenoh._generated.robot import ROBOT
from beatrix_zenoh._generated.serial import Telemetry
from beatrix_zenoh.node.course import Course

COURSE = Course(ROBOT)


def at(steps: int) -> Telemetry:
    """A board that says that its arms rest there."""
    return Telemetry(0, 1, 3, 0, 0, (steps, steps, steps), (0, 0, 0), 0)


@pytest.mark.parametrize("steps", [40_000, -40_000])
def test_counters_too_far_for_a_move_are_refused_with_what_to_do(steps: int) -> None:
    little = MotionQuery(absolute=False, position=Vector3(0.0, 0.0, 0.0))
    with pytest.raises(Refused, match=r"32767 microsteps from home.*calibrate") as refusal:
        COURSE.goal(little, at(steps))
    assert refusal.value.reason is Reason.BAD_VALUE


def test_what_a_move_can_say_is_packed_as_asked() -> None:
    goal = COURSE.goal(PoseQuery(yaw=-3.0), at(0))
    assert goal.frame(7).unpack(goal.frame(7).pack()) == goal.frame(7)
    assert goal.steps == (-1998, -1998, -1998)


def test_the_way_that_is_checked_is_the_one_the_board_is_told() -> None:
    """Slow arms are rounded by so much that they would take another way: the head tilted by 40 deg."""
    quarter = COURSE.gear.quarters_to_speed((1, 1, 1))[0]
    speed = Vector3(7.87 * quarter, 5.58 * quarter, 3.44 * quarter)
    goal = COURSE.goal(MotionQuery(position=Vector3(0.2, -0.1, -0.15), speed=speed), at(0))
    assert goal.quarters == (7, 5, 3)
    velocities = [section.velocity for section in goal.trajectory.sections]
    fastest = [max(abs(velocity[arm]) for velocity in velocities) for arm in range(3)]
    assert fastest == pytest.approx([7 * quarter, 5 * quarter, 3 * quarter])


@pytest.mark.parametrize("count", [1, 2, 3, 4188])
def test_speeds_the_board_can_be_told_are_told_as_they_are(count: int) -> None:
    speed = struct.unpack("f", struct.pack("f", COURSE.gear.quarters_to_speed((count,) * 3)[0]))[0]
    assert COURSE.gear.speed_to_quarters((speed,) * 3) == (count,) * 3


def test_a_way_begins_as_fast_as_telemetry_says() -> None:
    moving = at(100)._replace(velocity=(209, 209, 209))
    (first, *_) = COURSE.goal(PoseQuery(yaw=0.5), moving).trajectory.sections
    assert first.velocity[0] == pytest.approx(209 / COURSE.gear.steps_per_turn * math.tau)
