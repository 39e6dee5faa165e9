"""A board with the boot loader of the Arduino Mega, which starts at every reset and must not receive data."""

from __future__ import annotations

from pathlib import Path

import pytest
from avr.mega import HEX, LOADER
from robots import Stage, assert_fails, ready, turning, wait_status

from beatrix_zenoh import Interrupted, Refused
from beatrix_zenoh.contract._generated.messages import Reason

pytestmark = pytest.mark.long("firmware of the Mega in real time")

END = ":00000001FF"


@pytest.fixture
def flash(tmp_path: Path) -> Path:
    """Return a hex file with the flash memory of a board: firmware and boot loader."""
    whole = tmp_path / "flash.hex"
    lines = [line for line in HEX.read_text("ascii").splitlines() if line != END]
    whole.write_text("\n".join([*lines, LOADER.read_text("ascii")]), "ascii")
    return whole


def test_a_board_with_a_boot_loader_is_found_at_the_start_and_after_a_reset(
    alone: Stage, tmp_path: Path, flash: Path
) -> None:
    mega = alone.mega(tmp_path / "board", "--firmware", str(flash))
    node = alone.hardware("bea", str(tmp_path / "board"))
    robot = ready(alone.robot("bea", "hw"))
    motion = turning(robot)
    mega.say("reset")
    assert_fails(motion.wait, Interrupted, Reason.BOARD_LOST)
    assert robot.positions().velocity.short == 0
    wait_status(robot, lambda status: status.board.connected, "found again")
    node.expect("The board was restarted")
    assert not robot.status().calibrated
    ready(robot).look(yaw=2, speed=60)


def test_the_refusal_of_a_new_board_says_to_flash_it(alone: Stage, tmp_path: Path) -> None:
    """A new board has only the boot loader."""
    alone.mega(tmp_path / "board", "--firmware", str(LOADER))
    node = alone.hardware("bea", str(tmp_path / "board"))
    silent = f"{tmp_path / 'board'} is silent. Check that the board is connected to this port."
    assert any(line.startswith(silent) for line in node.lines)
    robot = alone.robot("bea", "hw")
    assert_fails(robot.enable, Refused, Reason.BOARD_LOST, "run `beatrix flash`")
