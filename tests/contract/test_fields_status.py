"""Status, clock and info: the meaning of each field, on every body; changes are published at once."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from importlib import metadata

import msgspec
import pytest
from bodies import Body
from late_tests import in_time
from published import at_once, published_statuses, regular
from robots import ask_raw

from beatrix_zenoh import Robot
from beatrix_zenoh.client.request import infos
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys, serial
from beatrix_zenoh.contract._generated.messages import (
    CONTRACT,
    Command,
    Fault,
    MotionReply,
    PoseQuery,
    Reason,
    Status,
)
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.gear import Gear
from beatrix_zenoh.motion.robot_file import fingerprint
from beatrix_zenoh.node.state import change_fields


@pytest.mark.measures_time
def test_a_ready_robot_publishes_its_status_each_second(body: Body, robot: Robot) -> None:
    statuses = published_statuses(robot)
    before = regular(statuses)
    assert (before.robot, before.side) == (body.name, body.side)
    assert (before.fault, before.warnings) == (Fault.NONE, [])
    assert (before.enabled, before.calibrated, before.moving) == (True, True, False)
    assert (before.plant is None) == (body.side == "hw")
    after = statuses.next()
    assert change_fields(after) == change_fields(before)
    now_s, now_wall_s = time.monotonic(), time.time()
    for period_ns in (after.t_mono_ns - before.t_mono_ns, after.t_wall_ns - before.t_wall_ns):
        assert period_ns > 0.8e9
        in_time(period_ns / 1e9, 1.2, "period of the status")
    for age_s in (now_s - after.t_mono_ns / 1e9, now_wall_s - after.t_wall_ns / 1e9):
        assert age_s >= 0
        in_time(age_s, 1.0, "age of a status that has just arrived")


@pytest.mark.measures_time
def test_changes_of_the_status_are_published_at_once(robot: Robot) -> None:
    statuses = published_statuses(robot)
    before = regular(statuses)

    def check(act: Callable[[], object], holds: Callable[[Status], bool]) -> Status:
        act()
        done_ns = time.monotonic_ns()
        status = statuses.next(holds)
        at_once(status, done_ns)
        return status

    check(robot.disable, lambda status: (status.enabled, status.calibrated) == (False, False))
    check(robot.enable, lambda status: (status.enabled, status.calibrated) == (True, False))
    check(robot.calibrate, lambda status: (status.enabled, status.calibrated) == (True, True))
    again = regular(statuses)
    after = check(robot.calibrate, lambda status: status.calibrations > again.calibrations)
    assert again.calibrations == before.calibrations + 1
    unchanged = msgspec.structs.replace(after, calibrations=again.calibrations)
    assert change_fields(unchanged) == change_fields(again), "nothing else has changed"
    target = keys.arm_target(robot.name, robot.side, "nose")
    warned = check(
        lambda: robot.client.bus.put(target, b"0.1", "text/plain"), lambda status: bool(status.warnings)
    )
    assert any("nose" in warning for warning in warned.warnings)


@pytest.mark.measures_time
def test_moving_and_motion_follow_the_running_motion(robot: Robot) -> None:
    statuses = published_statuses(robot)
    numbers = []
    for yaw in (0.1, 0.0):
        key = keys.pose(robot.name, robot.side, "ana")
        replies = ask_raw(robot.client, key, codec.encode(PoseQuery(yaw=yaw)), codec.MSGPACK)
        numbers.append(codec.decode(replies[0].payload, MotionReply).motion)
        running = statuses.next(lambda status: status.moving)
        rests = statuses.next(lambda status: not status.moving)
        assert running.motion == rests.motion == numbers[-1]
        lasted_s = (rests.t_mono_ns - running.t_mono_ns) / 1e9
        assert lasted_s > 0.11
        in_time(lasted_s, 0.61, "a motion of 0.36 s")
    assert len({0, *numbers}) == 3


def test_board_status_describes_the_board(body: Body, robot: Robot) -> None:
    board = robot.status().board
    assert board.connected
    assert board.port.endswith("/board") if body.kind == "mega" else board.port == "virtual:"
    assert board.name == ("" if body.kind == "mega" else body.name)
    assert board.firmware.count(".") == 2
    assert board.contract == f"{serial.CONTRACT:08x}"
    assert board.boot >= 1
    again = robot.status().board
    assert msgspec.structs.replace(again, retries=0, rejected_frames=0) == msgspec.structs.replace(
        board, retries=0, rejected_frames=0
    )


@pytest.mark.bodies("sim")
def test_a_simulation_has_a_plant_status(robot: Robot) -> None:
    statuses = published_statuses(robot)
    plant = regular(statuses).plant
    assert plant is not None
    assert 0 < plant.real_time_factor < 1.1, "it may be slower on a busy computer"
    assert plant.late_steps >= 0
    assert (plant.slipped_steps, plant.re_placed) == (0, 0)


def test_info_has_name_and_versions(body: Body, robot: Robot) -> None:
    info = robot.info()
    assert (info.robot, info.side) == (body.name, body.side)
    assert info.version == metadata.version("beatrix-zenoh")
    assert info.contract == CONTRACT
    assert info.firmware == robot.status().board.firmware
    assert info.fingerprint == fingerprint(ROBOT)
    assert info.arms == ["short", "middle", "long"]
    assert info.steps_per_turn == pytest.approx(Gear().steps_per_turn)


def test_info_has_limits_and_geometry_in_radians_on_the_wire(robot: Robot) -> None:
    info = infos(robot.client)[robot.place]
    assert info.geometry is not None
    for sent, own in ((info.limits, ROBOT.limits), (info.geometry, ROBOT.geometry)):
        for name, value in msgspec.structs.asdict(sent).items():
            given = getattr(own, name)
            assert value == (given if name == "hand" else pytest.approx(math.radians(given))), name


def test_info_lists_commands_reasons_keys_and_examples(body: Body, robot: Robot) -> None:
    info = robot.info()
    assert [line.partition(":")[0] for line in info.commands] == [
        f"{command.value} {command.name}" for command in Command
    ]
    assert [line.partition(":")[0] for line in info.reasons] == [str(reason) for reason in Reason]
    rows = {name: row for name, row in keys.KEYS.items() if body.side in row.sides}
    assert [(key.kind, key.payload, key.reply, key.doc_) for key in info.keys] == [
        (row.kind, row.payload, row.reply, keys.KEY_TEXT[name]) for name, row in rows.items()
    ]
    listed = [key.key for key in info.keys]
    assert keys.positions(body.name, body.side) in listed
    assert keys.motion(body.name, body.side, "<who>") in listed
    assert any("preview" in key for key in listed) == (body.side == "sim")
    assert len(info.examples) >= 5
    assert all(f"beatrix/{body.name}/{body.side}/" in line for line in info.examples)
