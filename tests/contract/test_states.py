"""Commands: the state after each, and refusals that name the next step."""

from __future__ import annotations

import pytest
from bodies import EVERY
from robots import assert_fails, ready, until

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Command, CommandQuery, Fault, Reason

pytestmark = pytest.mark.bodies(*EVERY)


def test_switching_the_motors_off_clears_the_calibration_which_a_motion_needs(robot: Robot) -> None:
    robot.disable()
    for request in (robot.calibrate, lambda: robot.look(yaw=5)):
        assert_fails(request, Refused, Reason.NOT_ENABLED, "enable")
    robot.enable()
    assert not robot.status().calibrated
    assert_fails(lambda: robot.look(yaw=5), Refused, Reason.NOT_CALIBRATED, "calibrate")


def test_calibrate_makes_the_present_position_home_and_reports_another_home(robot: Robot) -> None:
    assert "known already" not in robot.command(Command.CALIBRATE).message
    robot.move(6, 6, 6, speed=60)
    assert "Home was known already, and the arms were at 6" in robot.command(Command.CALIBRATE).message
    assert robot.positions().commanded == (0, 0, 0)


def test_calibrate_far_from_a_known_home_is_refused(robot: Robot) -> None:
    """The yaw limit, which protects the cables, counts from home; repeated calibration would bypass it."""
    robot.move(20, 20, 20, speed=80)
    assert_fails(robot.calibrate, Refused, Reason.HOME_KNOWN, "20")
    assert robot.positions().commanded == pytest.approx((20, 20, 20), abs=0.1)
    robot.disable()
    robot.enable()
    robot.calibrate()
    assert robot.positions().commanded == (0, 0, 0)


@pytest.mark.bodies(*EVERY, safety=True)
def test_requests_sent_before_emergency_stop_do_not_switch_the_motors_on(robot: Robot) -> None:
    key = keys.command(robot.name, robot.side, "ana")
    enable = codec.encode(CommandQuery(command=Command.ENABLE.value))
    queries = [robot.client.bus.query(key, enable, codec.MSGPACK, "interactive_high") for _ in range(40)]
    reply = robot.emergency_stop()
    assert "latched" in reply.message
    for query in queries:
        while query.next(8.0) is not None:
            pass
        query.close()
    status = robot.status()
    assert (status.enabled, status.fault) == (False, Fault.EMERGENCY)


def test_disable_ends_a_motion_which_calibrate_does_not(robot: Robot) -> None:
    motion = robot.look(yaw=30, wait=False)
    assert_fails(robot.calibrate, Refused, Reason.NOT_AT_REST)
    robot.disable()
    assert_fails(motion.wait, Interrupted, Reason.NOT_ENABLED)


@pytest.mark.bodies(*EVERY, safety=True)
def test_emergency_stop_is_latched_until_reset(robot: Robot) -> None:
    motion = robot.look(yaw=30, wait=False)
    robot.emergency_stop()
    assert_fails(motion.wait, Interrupted, Reason.FAULT)
    until(lambda: robot.status().fault is Fault.EMERGENCY, "fault shown")
    for request in (robot.enable, robot.calibrate, robot.home, lambda: robot.look(yaw=5)):
        assert_fails(request, Refused, Reason.EMERGENCY, "RESET")
    robot.disable()
    assert robot.status().fault is Fault.EMERGENCY
    robot.command(Command.RESET)
    status = robot.status()
    assert (status.fault, status.enabled, status.calibrated) == (Fault.NONE, False, False)
    ready(robot)
    assert robot.status().fault is Fault.NONE
    robot.look(yaw=2, speed=60)
