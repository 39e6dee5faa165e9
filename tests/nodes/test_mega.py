"""The hardware node on the real firmware: a simulated Mega behind a pseudo-terminal, in real time."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest
from stage import Process, Stage, ready, until, wait_status

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, CommandReply, Reason
from beatrix_zenoh._generated.serial import FrameType, Move
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.errors import BeatrixError
from hw_node.port import SerialPort

KEPT_MS = 5.0
"""Behind real time in half of all slices, on however busy a machine; on one of its own it is 0.1."""

PATIENCE_S = 2.0
"""For an answer that must not get lost: where a shared machine stands still for a tenth of a second it is only late."""


def test_node_enables_calibrates_looks_and_stops(tmp_path: Path) -> None:
    with Stage() as stage:
        mega = stage.mega(tmp_path / "board")
        stage.hardware("bea", str(tmp_path / "board"))
        robot = ready(stage.robot("bea", "hw"))
        robot.look(yaw=10, speed=60)
        until(lambda: abs(robot.positions().head.yaw - 10) < 0.2, "head turned")
        motion = robot.look(yaw=60, wait=False)
        until(lambda: robot.positions().commanded.short > 15, "moving")
        robot.stop()
        with pytest.raises(Interrupted) as ended:
            motion.wait()
        assert ended.value.reason is Reason.STOPPED
        assert robot.positions().commanded.short < 55
        assert robot.status().enabled
        mega.say("quit")
        behind = mega.expect("behind real time").rpartition(":")[2]
        assert float(behind.split(",")[0]) < KEPT_MS


class Told(NamedTuple):
    node: Process
    mega: Process
    robot: Robot

    def say(self, word: str) -> None:
        """Work the board, and wait until it has obeyed."""
        self.mega.say(word)
        self.mega.expect(word)


@pytest.fixture
def told(tmp_path: Path) -> Iterator[Told]:
    """A robot with its motors on and calibrated, and the board under it."""
    with Stage() as stage:
        mega = stage.mega(tmp_path / "board")
        node = stage.hardware("bea", str(tmp_path / "board"))
        yield Told(node, mega, ready(stage.robot("bea", "hw")))


@pytest.mark.parametrize(
    ("loss", "cure", "calibrated"), [("unplug", "plug", False), ("freeze", "go", True), ("reset", "", False)]
)
def test_a_board_lost_in_mid_move_is_told_and_found_again(
    told: Told, loss: str, cure: str, calibrated: bool
) -> None:
    robot = told.robot
    boot = robot.status().board.boot
    motion = robot.look(yaw=40, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    told.say(loss)
    with pytest.raises(Interrupted) as ended:
        motion.wait()
    assert ended.value.reason is Reason.BOARD_LOST
    assert ("was reset" in ended.value.message) == (loss == "reset")
    if cure:
        wait_status(robot, lambda status: not status.board.connected, "board lost shown")
        assert not robot.status().moving
        assert not robot.status().enabled
        for ask in (robot.calibrate, robot.stop, lambda: robot.look(yaw=1)):
            with pytest.raises(BeatrixError) as refused:
                ask()
            assert refused.value.reason is Reason.BOARD_LOST
            assert ("NOT stopped" in refused.value.message) == (ask == robot.stop)
            assert "Errno" not in refused.value.message
        told.node.expect(str(robot.status().board.port))  # is silent, or is not there
        told.say(cure)
        told.node.expect("The board at")
    wait_status(robot, lambda status: status.board.connected and not status.moving, "board heard again", 10.0)
    status = robot.status()
    assert status.calibrated == calibrated
    assert (status.board.boot > boot) == (not calibrated)
    assert any("was restarted" in warning for warning in status.warnings) == (not calibrated)
    if not calibrated:
        told.node.expect("The board was restarted")
    ready(robot).look(yaw=2, speed=60)


def test_a_board_that_was_just_reset_knows_no_home_when_it_is_enabled(told: Told) -> None:
    told.say("reset")
    query, key = CommandQuery(command=Command.ENABLE, value=True), keys.command("bea", "hw", "ana")
    reply = told.robot.client.ask("bea", "hw", key, query, CommandReply, 3.0)
    assert "home is known" not in reply.message
    wait_status(told.robot, lambda status: status.board.connected and not status.calibrated, "seen as reset")


def test_a_node_after_another_on_a_board_that_was_not_reset_moves_and_stops(tmp_path: Path) -> None:
    with Stage() as stage:
        stage.mega(tmp_path / "board")
        first = stage.hardware("bea", str(tmp_path / "board"))
        robot = ready(stage.robot("bea", "hw"))
        motion = robot.look(yaw=40, wait=False)
        until(lambda: robot.positions().commanded.short > 5, "moving")
        robot.stop()
        with pytest.raises(Interrupted):
            motion.wait()
        first.end()
        stage.hardware("bea", str(tmp_path / "board"))
        again = stage.robot("bea", "hw")
        assert again.status().calibrated, "the board has kept it"
        again.look(yaw=40)  # in the very words of the first
        assert abs(again.positions().head.yaw - 40) < 0.2
        assert again.stop().result


def test_a_motion_goes_not_on_when_a_frozen_board_is_back(told: Told) -> None:
    robot = told.robot
    motion = robot.look(yaw=100, speed=20, wait=False)
    until(lambda: robot.positions().commanded.short > 5, "moving")
    told.say("freeze")
    with pytest.raises(Interrupted):
        motion.wait()
    told.say("go")
    wait_status(robot, lambda status: status.board.connected and not status.moving, "back, and stopped", 10.0)
    assert robot.positions().commanded.short < 50


def test_one_lost_answer_costs_one_retry(told: Told) -> None:
    told.say("swallow")
    told.robot.look(yaw=2, speed=60)
    status = told.robot.status()
    assert status.board.retries == 1
    assert status.calibrated
    assert status.board.connected


def test_a_noisy_line_delays_and_misleads_nobody(told: Told) -> None:
    robot = told.robot
    told.say("noise")
    reasons = []
    for number in range(40):
        target = 4.0 * (1 + number % 2)
        try:
            robot.look(yaw=target, speed=90)
        except BeatrixError as error:  # a request may be lost every time; then nobody claims that it was done
            reasons.append(error.reason)
            wait_status(robot, lambda status: status.board.connected and not status.moving, "heard again")
    told.say("quiet")
    assert len(reasons) < 20
    assert set(reasons) <= {Reason.BOARD_LOST}
    assert robot.status().board.rejected_frames > 0
    robot.look(yaw=0)
    assert robot.positions().commanded == (0, 0, 0)


def test_two_callers_at_once_get_their_own_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beatrix_zenoh.board.board.REPLY_S", PATIENCE_S)
    with Stage() as stage:
        stage.mega(tmp_path / "board")
        board = Board(lambda: SerialPort(str(tmp_path / "board")), lambda _: None, lambda: None)
        board.start()
        try:
            until(lambda: board.link.connected, "greeted")

            def refused(kind: FrameType, payload: bytes, reason: Reason) -> None:
                for _ in range(100):
                    with pytest.raises(Refused) as refusal:
                        board.request(kind, payload)
                    assert refusal.value.reason is reason

            def granted(kind: FrameType) -> None:
                for _ in range(100):
                    board.request(kind)

            move = Move(1, (100, 100, 100), (800, 800, 800)).pack()
            with ThreadPoolExecutor() as callers:
                asked = [
                    callers.submit(refused, FrameType.MOVE, move, Reason.NOT_ENABLED),
                    callers.submit(refused, FrameType.ENABLE, b"\x07", Reason.BAD_VALUE),
                    callers.submit(granted, FrameType.STOP),
                ]
                for one in asked:
                    one.result(timeout=30)
            assert board.link.rejected == 0
            assert board.link.retries == 0
        finally:
            board.close()
