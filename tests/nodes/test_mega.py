"""The hardware node on the real firmware: a simulated Mega behind a pseudo-terminal, in real time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from robots import Process, Stage, ready, until, wait_status

from beatrix_zenoh import Interrupted, Robot
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError


def test_a_node_on_the_real_firmware_enables_calibrates_moves_and_stops(tmp_path: Path) -> None:
    with Stage() as stage:
        stage.mega(tmp_path / "board")
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


class MegaRobot(NamedTuple):
    node: Process
    mega: Process
    robot: Robot

    def say(self, word: str) -> None:
        """Send a command to the simulated board and wait for its echo."""
        self.mega.say(word)
        self.mega.expect(word)


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[MegaRobot]:
    """A robot and its simulated board; each test leaves the board running and connected."""
    path = tmp_path_factory.mktemp("mega") / "board"
    with Stage() as stage:
        mega = stage.mega(path)
        node = stage.hardware("bea", str(path))
        yield MegaRobot(node, mega, stage.robot("bea", "hw"))


@pytest.fixture
def mega_robot(shared: MegaRobot) -> MegaRobot:
    """The robot with its motors on and calibrated, at home."""
    wait_status(shared.robot, lambda status: status.board.connected and not status.moving, "connected")
    shared.robot.disable()
    ready(shared.robot)
    return shared


@pytest.mark.long("firmware of the Mega in real time")
@pytest.mark.parametrize(
    ("loss", "cure", "calibrated"),
    [
        ("freeze", "go", True),
        ("unplug", "plug", False),
        ("reset", "", False),
    ],  # freeze comes first, because a warning about a restart may remain
)
def test_a_board_that_is_lost_during_a_motion_is_reported_and_found_again(
    mega_robot: MegaRobot, loss: str, cure: str, calibrated: bool
) -> None:
    robot = mega_robot.robot
    boot = robot.status().board.boot
    motion = robot.look(yaw=100, speed=20, wait=False)
    until(lambda: robot.positions().commanded.short > 1, "moving")
    mega_robot.say(loss)
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
        mega_robot.node.expect(str(robot.status().board.port))  # the port is silent or missing
        mega_robot.say(cure)
    wait_status(
        robot, lambda status: status.board.connected and not status.moving, "board connected again", 10.0
    )
    assert robot.positions().commanded.short < 50, "the motion is not continued"
    status = robot.status()
    assert status.calibrated == calibrated
    assert (status.board.boot > boot) == (not calibrated)
    assert any("was restarted" in warning for warning in status.warnings) == (not calibrated)
    back = ("The board at",) if cure else ()
    mega_robot.node.expect_all(*back, *(() if calibrated else ("The board was restarted",)))
    ready(robot).look(yaw=2, speed=60)


@pytest.mark.long("firmware of the Mega in real time")
def test_a_second_node_on_a_board_without_reset_moves_and_stops(tmp_path: Path) -> None:
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
        assert again.status().calibrated, "the board has kept its home"
        again.look(yaw=40)  # the same request as that of the first node
        assert abs(again.positions().head.yaw - 40) < 0.2
        assert again.stop().result
