"""The contract of a firmware that was built for another robot."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from shutil import copytree

import pytest

from beatrix_zenoh._generated.serial import CONTRACT

SCHEMAS = Path(__file__).resolve().parents[2] / "schemas"


def generate(folder: Path, robot: str, schemas: Path = SCHEMAS) -> subprocess.CompletedProcess[str]:
    """Write the header of a robot whose file has this text."""
    (folder / "other.toml").write_text(robot, encoding="utf-8")
    command = [sys.executable, str(schemas / "generate.py"), "--robot", str(folder / "other.toml")]
    command += ["--header", str(folder / "contract.h")]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=30)


def contract(folder: Path, robot: str, schemas: Path = SCHEMAS) -> int:
    """Its contract."""
    done = generate(folder, robot, schemas)
    assert done.returncode == 0, done.stderr
    found = re.search(r"CONTRACT = (0x\w+)UL", (folder / "contract.h").read_text(encoding="utf-8"))
    assert found
    return int(found[1], 16)


@pytest.mark.parametrize(
    "robot",
    [
        "[drive]\nmicrosteps = 16",
        "[drive]\nfull_steps = 400",
        "[drive]\ngear_ring = 67",
        "[drive]\ngear_pinion = 25",
        "[geometry]\narm_spacing = 119.0",
        "[limits]\nguard_gap_min = 20.0",
        "[limits]\nguard_yaw_max = 300.0",
        "[limits]\nspeed_max = 91.0",
        "[limits]\nacceleration = 181.0",
        "[limits]\ntext_speed = 201.0",
        "[limits]\ntext_yaw_max = 180.0",
        "[limits]\ntilt_gap_min = 50.0",
        "[limits]\ntilt_gap_max = 170.0",
    ],
)
def test_what_is_compiled_into_the_firmware_is_part_of_the_contract(tmp_path: Path, robot: str) -> None:
    assert contract(tmp_path, robot) != CONTRACT


@pytest.mark.parametrize(
    "robot", ["", "[limits]\ntilt_max = 20.0\n[head]\nmass = 2", "[drive]\nmicrosteps = 8"]
)
def test_what_the_firmware_does_not_know_is_not(tmp_path: Path, robot: str) -> None:
    assert contract(tmp_path, robot) == CONTRACT


@pytest.mark.parametrize(
    ("there", "instead", "same"),
    [
        ("# Host <-> firmware", "# Node and board", True),
        ('doc = "motors are off"', 'doc = "switch the motors on first"', True),
        ('count = 3, unit = "microstep", doc', 'count = 3, unit = "step", doc', False),
        ("STOPPED = { code = 2", "STOPPED = { code = 20", False),
        ("reply_timeout = { value = 100", "reply_timeout = { value = 101", False),
    ],
)
def test_better_words_are_no_other_contract(tmp_path: Path, there: str, instead: str, *, same: bool) -> None:
    schemas = copytree(SCHEMAS, tmp_path / "schemas")
    text = (schemas / "serial.toml").read_text(encoding="utf-8")
    assert there in text
    (schemas / "serial.toml").write_text(text.replace(there, instead), encoding="utf-8")
    assert (contract(tmp_path, "", schemas) == CONTRACT) is same


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        ("[drives]\nmicrosteps = 16", r"'drives' is no table; there are geometry, drive"),
        ("[drive]\nmicrostep = 16", r"\[drive\] has no 'microstep'; there are full_steps, microsteps"),
        ("[drive]\nmicrosteps = 'many'", r"\[drive\] microsteps = 'many': give a number above 0"),
        ("[drive]\nmicrosteps = 0", r"microsteps = 0: give a number above 0"),
        ("[drive]\nmicrosteps = 64", r"microsteps = 64: jumpers can say 1, 2, 4, 8, 16, 32"),
        (
            "[limits]\nspeed_max = 9000",
            r"speed_max: with this gear and these microsteps a frame can say up to 1409 deg/s",
        ),
        ("[limits]\nacceleration = inf", r"other\.toml: cannot convert float infinity"),
        ("[drive\n", r"other\.toml: Expected ']'"),
    ],
)
def test_a_file_that_can_mean_nothing_is_told_so(tmp_path: Path, robot: str, why: str) -> None:
    done = generate(tmp_path, robot)
    assert done.returncode == 2
    assert re.search(why, done.stderr), done.stderr
    assert "Traceback" not in done.stderr
