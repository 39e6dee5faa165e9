"""A lab's own robot: what it may say, and what it is told."""

from __future__ import annotations

from pathlib import Path

import pytest

from beatrix_zenoh import robot_file
from beatrix_zenoh._generated.robot import ROBOT
from beatrix_zenoh.errors import WrongUsage


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "lab.toml"
    path.write_text(text)
    return path


def test_given_values_take_the_place_of_shipped_ones(tmp_path: Path) -> None:
    robot = robot_file.load(write(tmp_path, "[geometry]\narm0_azimuth = 30\n[limits]\ntilt_max = 20.0\n"))
    assert (robot.geometry.arm0_azimuth, robot.limits.tilt_max) == (30.0, 20.0)
    assert (robot.drive, robot.head) == (ROBOT.drive, ROBOT.head)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[geometri]\na = 1\n", "'geometri' is no table. There are: geometry, drive"),
        ("[geometry]\narm_angel = 1\n", r"\[geometry\] has no 'arm_angel'. There are: arm_angle"),
        ("[geometry]\narm_angle = 'wide'\n", "Expected `float`"),
        ("[drive]\nsign = [-1, 1, 1]\n", "compiled into the firmware.*turn its plug round"),
        ("geometry = 3\n", "is no table"),
        ("[geometry\n", "cannot be read"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(WrongUsage, match=why):
        robot_file.load(write(tmp_path, text))


def test_a_missing_file_is_said(tmp_path: Path) -> None:
    with pytest.raises(WrongUsage, match="cannot be read"):
        robot_file.load(tmp_path / "none.toml")
