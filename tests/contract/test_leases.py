"""Leases over real sessions: a seat takes the robot, others wait, the teacher freezes it and limits its speed."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from bodies import Body
from robots import assert_fails, until

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated.messages import LeaseAction, LeaseQuery, Reason

pytestmark = pytest.mark.bodies("in-process")  # the node alone decides about leases


@pytest.fixture(autouse=True)
def left_free(body: Body) -> Iterator[None]:
    """Free the robot after the test: a seat that moved it would hold it for some time."""
    yield
    teacher = body.robot("teacher")
    lease.ask(teacher, LeaseAction.UNFREEZE)
    lease.ask(teacher, LeaseAction.LIMIT)
    lease.ask(teacher, LeaseAction.TURN)
    lease.ask(teacher, LeaseAction.GIVE_BACK)
    until(lambda: teacher.status().holder == "", "the robot is free")
    body.stage.close_clients()


def test_a_robot_that_is_taken_moves_for_its_holder_only(body: Body, robot: Robot) -> None:
    ben = body.robot("ben")
    with robot.lease() as held:
        status = robot.status()
        assert (status.holder, status.lease) == ("ana", held.number)
        robot.look(yaw=2, speed=60)
        assert_fails(lambda: ben.look(yaw=-2), Refused, Reason.NOT_HOLDER, "ana has taken this robot")
        ben.stop()
    until(lambda: robot.status().holder == "", "given back")
    ben.look(yaw=0, speed=60)


def test_the_seat_that_waits_gets_the_robot_when_the_holder_leaves(body: Body, robot: Robot) -> None:
    holder, dora = body.robot("cleo"), body.robot("dora")
    holder.lease()
    with pytest.raises(Refused):
        dora.lease(wait_s=0.2)
    assert robot.status().waiting == [], "a seat that no longer waits is not in the queue"
    lease.ask(dora, LeaseAction.WAIT)
    assert robot.status().waiting == ["dora"]
    holder.client.close()
    until(lambda: robot.status().holder == "dora", "handed over")
    with dora.lease(wait_s=1.0):
        dora.look(yaw=2, speed=60)


def test_a_frozen_robot_moves_for_the_teacher_only(body: Body, robot: Robot) -> None:
    teacher = body.robot("teacher")
    assert_fails(lambda: lease.ask(robot, LeaseAction.FREEZE), Refused, Reason.TEACHER_ONLY)
    motion = robot.look(yaw=25, wait=False)
    lease.ask(teacher, LeaseAction.FREEZE)
    with pytest.raises(Interrupted, match="by the teacher, who has frozen the robot"):
        motion.wait()
    assert robot.status().frozen
    assert_fails(lambda: robot.look(yaw=0), Refused, Reason.FROZEN)
    teacher.look(yaw=1, speed=60)
    lease.ask(teacher, LeaseAction.UNFREEZE)
    assert not robot.status().frozen


def test_the_speed_limit_of_the_teacher_stops_and_refuses_faster_motions(body: Body, robot: Robot) -> None:
    teacher = body.robot("teacher")
    assert_fails(
        lambda: lease.ask(teacher, LeaseAction.LIMIT, lease.limit_of(2.0)), Refused, Reason.SPEED_LIMIT
    )
    motion = robot.look(yaw=60, speed=30, wait=False)
    assert (
        "A faster motion was stopped" in lease.ask(teacher, LeaseAction.LIMIT, lease.limit_of(10.0)).message
    )
    with pytest.raises(Interrupted, match="by the teacher, whose new speed limit is lower"):
        motion.wait()
    home = robot.look(yaw=0, wait=False)
    assert "stopped" not in lease.ask(teacher, LeaseAction.LIMIT, lease.limit_of(10.0)).message, (
        "this motion is slow enough"
    )
    home.wait()
    advice = r"the teacher's limit of 10\.0°/s applies\. Try a speed of 10\.0°/s"
    assert_fails(lambda: robot.look(yaw=2, speed=60), Refused, Reason.SPEED_LIMIT, advice)
    assert robot.look(yaw=5).duration > 0.5
    assert robot.status().speed_limit == pytest.approx(0.1745, abs=0.001)
    lease.ask(teacher, LeaseAction.LIMIT)
    robot.look(yaw=0, speed=60)


@pytest.mark.long("waits for the end of a turn")
def test_a_turn_ends_in_mid_move_and_the_next_seat_gets_the_robot(body: Body, robot: Robot) -> None:
    teacher, ben = body.robot("teacher"), body.robot("ben")
    assert "at most 5 s" in lease.send(teacher, LeaseQuery(action=LeaseAction.TURN, longest_s=5)).message
    held = lease.Lease(robot, 0.0, speed=math.radians(10))
    # the lease has a speed of its own
    assert_fails(lambda: robot.look(yaw=5, speed=20), Refused, Reason.SPEED_LIMIT)
    lease.ask(ben, LeaseAction.WAIT)
    assert 0 < robot.status().turn_s <= 5
    motion = robot.look(yaw=100, wait=False)
    until(lambda: robot.status().holder == "ben", "handed over")
    with pytest.raises(Interrupted, match="the time of this turn is over"):
        motion.result(10.0)
    with pytest.raises(Refused):
        robot.look(yaw=0)
    robot.lease_number, held.number = 0, 1
    ben.look(yaw=0, speed=60)
