"""The hardware node on the real firmware: a simulated Mega behind a pseudo-terminal, in real time."""

from __future__ import annotations

from pathlib import Path

import pytest
from stage import Stage, ready, until, wait_status

from beatrix_zenoh import Interrupted
from beatrix_zenoh._generated.messages import Reason

KEPT_MS = 5.0
"""Behind real time in half of all slices, on however busy a machine; on one of its own it is 0.1."""


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


def test_node_finds_the_board_again_after_a_reset_in_mid_move(tmp_path: Path) -> None:
    with Stage() as stage:
        mega = stage.mega(tmp_path / "board")
        stage.hardware("bea", str(tmp_path / "board"))
        robot = ready(stage.robot("bea", "hw"))
        motion = robot.look(yaw=40, wait=False)
        until(lambda: robot.positions().commanded.short > 1, "moving")
        mega.say("reset")
        with pytest.raises(Interrupted) as ended:
            motion.wait()
        assert ended.value.reason is Reason.BOARD_LOST
        wait_status(robot, lambda status: status.board.boot == 2 and status.board.connected, "found again")
        assert (robot.status().enabled, robot.status().calibrated) == (False, False)
        ready(robot).look(yaw=2, speed=60)


def test_node_hears_a_frozen_board_again(tmp_path: Path) -> None:
    with Stage() as stage:
        mega = stage.mega(tmp_path / "board")
        stage.hardware("bea", str(tmp_path / "board"))
        robot = ready(stage.robot("bea", "hw"))
        mega.say("freeze")
        wait_status(robot, lambda status: not status.board.connected, "board lost shown")
        mega.say("go")
        wait_status(robot, lambda status: status.board.connected, "board heard again")
        assert robot.status().calibrated, "it was never reset"
