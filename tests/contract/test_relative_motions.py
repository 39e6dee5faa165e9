"""Relative motions on every way into a robot: their parts of a microstep add up, until something else moves the arms."""

from __future__ import annotations

import pytest
from robots import until

from beatrix_zenoh import Robot
from beatrix_zenoh.motion.gear import Gear

STEP_DEG = 360 / Gear().steps_per_turn
HALF_DEG = STEP_DEG / 2 * 1.001


def assert_stands_at(robot: Robot, angle: float) -> None:
    """Assert that the set points of all arms are within half a microstep of an angle (deg)."""
    assert tuple(robot.positions().commanded) == pytest.approx((angle,) * 3, abs=HALF_DEG)


@pytest.mark.bodies("in-process", "mega")
def test_small_relative_motions_end_at_their_sum(robot: Robot) -> None:
    for _ in range(30):
        robot.look(yaw=0.04, relative=True, speed=60)
    assert_stands_at(robot, 30 * 0.04)


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
