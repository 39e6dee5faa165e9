"""The hardware node on the real firmware: a simulated Mega behind a pseudo-terminal, in real time."""

from __future__ import annotations

from pathlib import Path

import pytest
from robots import Stage, assert_fails, ready, until

from beatrix_zenoh import Interrupted
from beatrix_zenoh.contract._generated.messages import Reason


def test_a_node_on_the_real_firmware_enables_calibrates_moves_and_stops(alone: Stage, tmp_path: Path) -> None:
    alone.mega(tmp_path / "board")
    alone.hardware("bea", str(tmp_path / "board"))
    robot = ready(alone.robot("bea", "hw"))
    robot.look(yaw=10, speed=60)
    until(lambda: abs(robot.positions().head.yaw - 10) < 0.2, "head turned")
    motion = robot.look(yaw=60, wait=False)
    until(lambda: robot.positions().commanded.short > 15, "moving")
    robot.stop()
    assert_fails(motion.wait, Interrupted, Reason.STOPPED)
    assert robot.positions().commanded.short < 55
    assert robot.status().enabled


@pytest.mark.long("firmware of the Mega in real time")
def test_a_second_node_on_a_board_without_reset_moves_and_stops(alone: Stage, tmp_path: Path) -> None:
    alone.mega(tmp_path / "board")
    first = alone.hardware("bea", str(tmp_path / "board"))
    robot = ready(alone.robot("bea", "hw"))
    motion = robot.look(yaw=40, wait=False)
    until(lambda: robot.positions().commanded.short > 5, "moving")
    robot.stop()
    with pytest.raises(Interrupted):
        motion.wait()
    first.end()
    alone.hardware("bea", str(tmp_path / "board"))
    again = alone.robot("bea", "hw")
    assert again.status().calibrated, "the board has kept its home"
    again.look(yaw=40)  # the same request as that of the first node
    assert abs(again.positions().head.yaw - 40) < 0.2
    assert again.stop().result
