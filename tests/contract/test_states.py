"""States and commands: what is missing is said, what was done is true, nothing is latched in secret."""

from __future__ import annotations

import pytest
from stage import ask_raw, ready, until

from beatrix_zenoh import Interrupted, Refused, Robot, codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, CommandReply, Fault, Reason


def test_motors_off_refuses_a_move_and_says_what_to_do(robot: Robot) -> None:
    robot.disable()
    with pytest.raises(Refused, match="enable") as refusal:
        robot.look(yaw=5)
    assert refusal.value.reason is Reason.NOT_ENABLED
    assert not robot.status().enabled


def test_move_before_calibration_is_refused(robot: Robot) -> None:
    robot.disable()
    robot.enable()
    with pytest.raises(Refused, match="calibrate") as refusal:
        robot.look(yaw=5)
    assert refusal.value.reason is Reason.NOT_CALIBRATED


def test_switching_the_motors_forgets_home(robot: Robot) -> None:
    assert robot.status().calibrated
    robot.disable()
    robot.enable()
    assert not robot.status().calibrated


def test_enabling_twice_changes_nothing(robot: Robot) -> None:
    robot.enable()
    assert robot.status().calibrated


def test_calibrate_needs_motors(robot: Robot) -> None:
    robot.disable()
    with pytest.raises(Refused) as refusal:
        robot.calibrate()
    assert refusal.value.reason is Reason.NOT_ENABLED


def test_calibrate_makes_the_present_position_home(robot: Robot) -> None:
    robot.move(6, 6, 6, speed=60)
    robot.calibrate()
    assert robot.positions().commanded == (0, 0, 0)


def test_calibrating_anew_elsewhere_is_told(robot: Robot) -> None:
    assert "known already" not in robot.command(Command.CALIBRATE).message
    robot.move(6, 6, 6, speed=60)
    assert "Home was known already, and the arms stood at 6" in robot.command(Command.CALIBRATE).message


def test_a_home_that_is_far_is_not_replaced(robot: Robot) -> None:
    """Else the head could turn on and on: what cables allow counts from home."""
    robot.move(20, 20, 20, speed=80)
    with pytest.raises(Refused, match="stand at 20") as refusal:
        robot.calibrate()
    assert refusal.value.reason is Reason.HOME_KNOWN
    assert robot.positions().commanded == pytest.approx((20, 20, 20), abs=0.1)
    robot.disable()
    robot.enable()
    robot.calibrate()
    assert robot.positions().commanded == (0, 0, 0)


def test_emergency_stop_holds_whatever_was_asked_before_it(robot: Robot) -> None:
    key = keys.command(robot.name, robot.twin, "ana")
    enable = codec.encode(CommandQuery(command=Command.ENABLE.value))
    questions = [robot.client.bus.question(key, enable, codec.MSGPACK, "interactive_high") for _ in range(40)]
    reply = robot.emergency_stop()
    assert "latched" in reply.message
    for question in questions:
        while question.next(8.0) is not None:
            pass
        question.close()
    status = robot.status()
    assert (status.enabled, status.fault) == (False, Fault.EMERGENCY)
    robot.enable()
    assert robot.status().enabled


def test_calibrate_in_motion_is_refused(robot: Robot) -> None:
    motion = robot.look(yaw=30, wait=False)
    with pytest.raises(Refused) as refusal:
        robot.calibrate()
    assert refusal.value.reason is Reason.NOT_AT_REST
    robot.stop()
    with pytest.raises(Interrupted):
        motion.wait()


def test_disabling_in_motion_ends_the_motion(robot: Robot) -> None:
    motion = robot.look(yaw=30, wait=False)
    robot.disable()
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.NOT_ENABLED


def test_emergency_stop_is_latched_until_enable(robot: Robot) -> None:
    motion = robot.look(yaw=30, wait=False)
    robot.emergency_stop()
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.FAULT
    until(lambda: robot.status().fault is Fault.EMERGENCY, "fault shown")
    with pytest.raises(Refused, match="emergency stop is latched"):
        robot.look(yaw=5)
    ready(robot)
    assert robot.status().fault is Fault.NONE
    robot.look(yaw=2, speed=60)


def test_unknown_command_lists_the_known_ones(robot: Robot) -> None:
    key = keys.command(robot.name, robot.twin, "ana")
    (answer,) = ask_raw(robot.client, key, codec.encode(CommandQuery(command=99)), codec.MSGPACK)
    reply = codec.decode(answer.payload, CommandReply)
    assert (reply.result, reply.reason) == (False, Reason.UNKNOWN_COMMAND)
    assert "2 CALIBRATE" in reply.message


def test_status_names_the_driver_until_it_has_rested(robot: Robot) -> None:
    robot.look(yaw=2, speed=60)
    assert robot.status().holder == "ana"
    until(lambda: robot.status().holder == "", "lease over", 4.0)
