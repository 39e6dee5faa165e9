"""Programs are killed or suspended, boards unplugged: every loss has a defined outcome, and a return is detected."""

from __future__ import annotations

import re
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from late_tests import within
from pty_board import PtyBoard
from robots import Stage, assert_fails, ready, turning, until, wait_status
from shell import beatrix

from beatrix_zenoh import Interrupted, NoAnswer, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated import serial
from beatrix_zenoh.contract._generated.messages import Fault, Reason
from beatrix_zenoh.node import Node
from hw_node.body import Hardware, VirtualHardware


@pytest.fixture
def stage() -> Iterator[Stage]:
    """A router for one test."""
    with Stage(traced=True) as made:
        yield made


def test_a_second_node_under_a_name_is_refused_and_the_first_continues(stage: Stage) -> None:
    stage.node("bea")
    robot = ready(stage.robot("bea", "hw"))
    second = beatrix("hw", "--name", "bea", "--connect", stage.endpoint, "--port", "virtual:")
    assert second.returncode == 1
    assert re.search("online.*--name", second.stderr)
    robot.look(yaw=2, speed=60)


def test_one_of_several_nodes_started_together_under_a_name_serves(stage: Stage) -> None:
    def start() -> Node | Refused:
        sessions = Sessions(lambda: zbus.connect(stage.endpoint))
        body = VirtualHardware("bea")
        gate.wait(10)
        try:
            return Node(sessions, "bea", body).start()
        except Refused as refused:
            sessions.close()
            body.close()
            return refused

    for _ in range(2):
        gate = threading.Barrier(4)
        with ThreadPoolExecutor(4) as pool:
            ends = [future.result(30) for future in [pool.submit(start) for _ in range(4)]]
        serving = [end for end in ends if isinstance(end, Node)]
        for node in serving:
            node.close()
        assert len(serving) == 1
        assert {end.reason for end in ends if isinstance(end, Refused)} == {Reason.NAME_TAKEN}


def test_a_killed_node_is_lost_at_once_and_may_return(stage: Stage) -> None:
    process = stage.hardware("bea")
    robot = ready(stage.robot("bea", "hw"))
    motion = robot.look(yaw=30, wait=False)
    process.end(signal.SIGKILL)
    assert_fails(motion.wait, NoAnswer, Reason.NODE_LOST)
    stage.node("bea")
    assert not robot.status().calibrated, "the home of a restarted board is not known"
    ready(robot).look(yaw=2, speed=60)


@pytest.mark.parametrize(("module", "number"), [("hw_node", signal.SIGINT), ("sim_node", signal.SIGTERM)])
def test_a_signal_stops_the_arms_and_ends_the_node(stage: Stage, module: str, number: signal.Signals) -> None:
    side = "sim" if module == "sim_node" else "hw"
    process = stage.simulation("bea") if side == "sim" else stage.hardware("bea")
    robot = ready(stage.robot("bea", side))
    motion = robot.look(yaw=60, wait=False)
    process.send(number)
    assert_fails(motion.wait, Interrupted, Reason.SHUTDOWN, "which is closing; the arms rest at")
    assert process.wait() == 0
    assert "Traceback" not in "\n".join(process.lines)


CLIENT = """
import sys
from beatrix_zenoh import Robot
robot = Robot("bea", "hw", connect=sys.argv[1], who="goner")
motion = robot.look(yaw=120, wait=False)
print("ready", flush=True)
motion.wait()
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_robot_stops_if_its_client_is_killed_or_suspended_during_a_motion(
    stage: Stage, tmp_path: Path, number: signal.Signals
) -> None:
    (tmp_path / "goner.py").write_text(CLIENT)
    stage.node("bea")
    robot = ready(stage.robot("bea", "hw"))
    goner = stage.script(tmp_path / "goner.py", stage.endpoint)
    goner.expect("ready")
    until(lambda: robot.positions().commanded.short > 2, "moving")
    goner.send(number)
    until(lambda: not robot.status().moving, "stopped: at once if killed, after 2 s if suspended")
    assert robot.positions().commanded.short < 110
    assert robot.status().holder == ""
    goner.end(signal.SIGKILL)


@pytest.mark.measures_time
def test_an_unplugged_board_ends_the_motion_and_is_found_again(stage: Stage, tmp_path: Path) -> None:
    with PtyBoard(tmp_path / "board") as board:
        stage.hardware("bea", str(board.path))
        robot = ready(stage.robot("bea", "hw"))
        motion = turning(robot, 40)
        board.unplug()
        with within(0.8, "the board is lost after 0.5 s, and shown"):
            wait_status(robot, lambda status: status.fault is Fault.BOARD_LOST, "board lost shown")
        lost = robot.status()
        assert (lost.enabled, lost.calibrated, lost.moving) == (False, False, False), "its state is unknown"
        assert any("silent" in warning for warning in lost.warnings)
        assert_fails(motion.wait, Interrupted, Reason.BOARD_LOST)
        with pytest.raises((Refused, NoAnswer), match="board"):
            robot.look(yaw=2)
        board.plug()
        wait_status(robot, lambda status: status.board.connected, "board found again")
        status = robot.status()
        assert (status.enabled, status.calibrated, status.board.boot) == (False, False, 2)
        ready(robot).look(yaw=2, speed=60)


def test_a_motion_that_begins_just_after_stop_is_stopped_too(stage: Stage) -> None:
    node = stage.node("bea")
    robot = ready(stage.robot("bea", "hw"))
    motion = turning(robot, 40)
    node.controller.stop_sent()  # as if STOP had reached the board before the motion
    assert_fails(motion.wait, Interrupted, Reason.STOPPED)


def test_a_new_node_shows_the_latch_of_the_board(stage: Stage, tmp_path: Path) -> None:
    with PtyBoard(tmp_path / "board") as board:
        stage.node("bea", Hardware(str(board.path)))
        ready(stage.robot("bea", "hw")).emergency_stop()
        stage.end_nodes()
        stage.node("bea", Hardware(str(board.path)))
        robot = stage.robot("bea", "hw", "ben")
        wait_status(robot, lambda status: status.fault is Fault.EMERGENCY, "latch found")
        assert_fails(robot.enable, Refused, Reason.EMERGENCY)
        ready(robot)
        stage.end_nodes()  # before its board


def test_a_motion_accepted_after_its_client_has_given_up_is_stopped(stage: Stage) -> None:
    process = stage.hardware("bea")
    watcher = ready(stage.robot("bea", "hw", "ben"))
    with Robot("bea", "hw", connect=stage.endpoint, who="ana", timeout_s=0.3) as robot:
        until(lambda: robot.status().calibrated, "calibrated")
        robot.look()  # a client queries the limits before its first motion, and later motions need no query
        before = watcher.status().motion
        process.send(signal.SIGSTOP)
        wake_up = threading.Timer(1.0, process.send, (signal.SIGCONT,))  # its session would be lost after 2 s
        wake_up.start()
        with pytest.raises(NoAnswer):
            robot.look(yaw=60)
        wake_up.join()
        until(
            lambda: watcher.status().motion != before and not watcher.status().moving,
            "begun late, and stopped",
        )
        assert watcher.positions().commanded.short < 10


def test_a_board_of_another_contract_is_not_moved_but_accepts_stop(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serial, "CONTRACT", 0xBAD)
    stage.node("bea")
    robot = stage.robot("bea", "hw")
    for ask in (robot.enable, robot.calibrate, robot.home, lambda: robot.look(yaw=1)):
        assert_fails(ask, Refused, Reason.CONTRACT_MISMATCH, "`beatrix flash`")
    status = robot.status()
    assert (status.fault, "`beatrix flash`" in status.warnings[0]) == (Fault.CONTRACT_MISMATCH, True)
    for stop in (robot.stop, robot.emergency_stop):
        assert "its state is unknown" in stop().message


def test_the_board_stops_the_arms_when_its_node_is_lost(stage: Stage, tmp_path: Path) -> None:
    with PtyBoard(tmp_path / "board") as board:
        process = stage.hardware("bea", str(board.path))
        robot = ready(stage.robot("bea", "hw"))
        turning(robot, 90)
        process.end(signal.SIGKILL)
        until(lambda: board.board.firmware.steps() == board.board.firmware.steps(), "readable")
        before = time.monotonic()
        steps = [board.board.firmware.steps()]

        def rests() -> bool:
            steps.append(board.board.firmware.steps())
            return time.monotonic() - before > 0.9 and steps[-1] == steps[-5]

        until(rests, "arms rest, because the heartbeat is missing")
        assert steps[-1][0] < 1000, "90 deg would be 1046 microsteps"
