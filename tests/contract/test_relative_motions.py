"""Relative motions on every way into a robot: their parts of a microstep add up, until something else moves the arms."""

from __future__ import annotations

import math

import pytest
from robots import ask_raw, until

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import PoseQuery, PreviewReply
from beatrix_zenoh.motion.gear import Gear

STEP_DEG = 360 / Gear().steps_per_turn
HALF_DEG = STEP_DEG / 2 * 1.001


def assert_stands_at(robot: Robot, angle: float) -> None:
    """Assert that the set points of all arms are within half a microstep of an angle (deg)."""
    assert tuple(robot.positions().commanded) == pytest.approx((angle,) * 3, abs=HALF_DEG)


@pytest.mark.bodies("in-process", "mega")
@pytest.mark.parametrize("by", [0.04, 0.05])
def test_thirty_small_relative_motions_end_at_their_sum(robot: Robot, by: float) -> None:
    for _ in range(30):
        robot.look(yaw=by, relative=True, speed=60)
    assert_stands_at(robot, 30 * by)


@pytest.mark.bodies("in-process")
def test_relative_motions_of_different_forms_add_up(robot: Robot) -> None:
    who = "ana"
    for turn in range(20):
        by = 0.03
        match turn % 4:
            case 0:
                robot.look(yaw=by, relative=True)
            case 1:
                robot.move(by, by, by, relative=True)
            case 2:
                words = " ".join([f"{math.radians(by):.8f}"] * 3) + " 1 relative"
                ask_raw(robot.client, keys.motion(robot.name, robot.side, who), words.encode(), "text/plain")
            case _:
                yaw = f"?yaw={math.radians(by):.8f};absolute=false"
                ask_raw(robot.client, keys.pose(robot.name, robot.side, who) + yaw)
    assert_stands_at(robot, 20 * 0.03)


@pytest.mark.bodies("in-process")
def test_a_relative_motion_after_a_per_arm_topic_counts_from_its_exact_angle(robot: Robot) -> None:
    until(lambda: robot.status().holder == "", "free", 5.0)
    for arm in ("short", "middle", "long"):
        key = keys.arm_target(robot.name, robot.side, arm)
        robot.client.bus.put(key, f"{math.radians(1.04):.8f}".encode(), "text/plain")
        until(lambda arm=arm: getattr(robot.positions().commanded, arm) > 1, "arrived")  # type: ignore[misc]
    until(lambda: robot.status().holder == "", "free", 5.0)
    for _ in range(10):
        robot.look(yaw=0.04, relative=True)
    assert_stands_at(robot, 1.04 + 10 * 0.04)


@pytest.mark.bodies("in-process")
def test_a_relative_motion_that_turns_no_arm_yet_says_so(robot: Robot) -> None:
    motion = robot.look(yaw=0.04, relative=True)
    assert "do not turn yet" in motion.accepted.message
    assert "do not turn yet" in motion.result().message
    assert motion.accepted.result
    assert motion.duration == 0
    assert "yet" not in robot.look(yaw=0.04, relative=True).result().message
    assert "yet" not in robot.move(0, 0, 0, relative=True).result().message


@pytest.mark.bodies("in-process")
def test_a_new_home_ends_the_sum(robot: Robot) -> None:
    robot.look(yaw=0.04, relative=True)
    robot.calibrate()
    robot.look(yaw=0.04, relative=True)
    assert_stands_at(robot, 0)
    assert robot.positions().commanded.short == 0
    robot.disable()
    robot.make_ready()
    robot.look(yaw=0.04, relative=True)
    assert robot.positions().commanded.short == 0


@pytest.mark.bodies("in-process")
def test_after_stop_a_relative_motion_counts_from_where_the_arms_rest(robot: Robot) -> None:
    robot.look(yaw=40, wait=False)
    until(lambda: robot.positions().commanded.short > 3, "moving")
    robot.stop()
    rests = robot.positions().commanded.short
    robot.look(yaw=1, relative=True)
    assert_stands_at(robot, rests + 1)


@pytest.mark.bodies("in-process")
def test_a_relative_motion_without_wait_counts_from_the_set_point_and_not_from_the_goal(robot: Robot) -> None:
    robot.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 3, "moving")
    motion = robot.look(yaw=2, relative=True)
    goal = math.degrees(motion.accepted.position.x)
    assert 5 < goal < 30
    assert_stands_at(robot, goal)


@pytest.mark.bodies("sim")
def test_a_preview_counts_from_the_same_angles_as_the_robot(robot: Robot) -> None:
    robot.look(yaw=0.04, relative=True)
    query = PoseQuery(absolute=False, yaw=math.radians(0.04))
    reply = ask(robot.client, (robot.name, "sim"), keys.preview(robot.name, "ana"), query, PreviewReply, 10.0)
    assert math.degrees(reply.arms[-1].x - reply.arms[0].x) > HALF_DEG, "one microstep, with friction"
    robot.look(yaw=0.04, relative=True)
    assert_stands_at(robot, STEP_DEG)
