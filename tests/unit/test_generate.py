"""The contract of firmware that was built for another robot."""

from __future__ import annotations

import contextlib
import io
import re
import subprocess
import sys
import unittest.mock
from pathlib import Path
from shutil import copytree

import generate
import pytest

from beatrix_zenoh.contract._generated.serial import CONTRACT

pytestmark = pytest.mark.no_cover  # runs only code of schemas/, whose coverage is not measured

SCHEMAS = Path(__file__).resolve().parents[2] / "schemas"


def header(folder: Path, robot: str) -> tuple[int, str]:
    """Write the header of a robot whose file has this text; return exit code and error output."""
    (folder / "other.toml").write_text(robot, encoding="utf-8")
    words = ["generate.py", "--robot", str(folder / "other.toml"), "--header", str(folder / "contract.h")]
    errors = io.StringIO()
    with unittest.mock.patch.object(sys, "argv", words), contextlib.redirect_stderr(errors):
        try:
            return generate.main(), errors.getvalue()
        except SystemExit as end:
            return int(end.code or 0), errors.getvalue()


def contract_in(path: Path) -> int:
    """Return the hash in a header."""
    found = re.search(r"CONTRACT = (0x\w+)UL", path.read_text(encoding="utf-8"))
    assert found
    return int(found[1], 16)


@pytest.mark.parametrize(
    ("robot", "same"),
    [
        ("[drive]\nmicrosteps = 16", False),
        ("[drive]\ngear_ring = 67", False),
        ("[geometry]\narm_spacing = 119.0", False),
        ("[limits]\nguard_gap_min = 20.0", False),
        ("[limits]\nspeed_max = 91.0", False),
        ("[limits]\ntilt_gap_min = 50.0", False),
        ("", True),
        ("[limits]\ntilt_max = 20.0\n[head]\nmass = 2", True),
        ("[drive]\nmicrosteps = 8", True),
    ],
)
def test_only_values_compiled_into_the_firmware_change_the_contract(
    tmp_path: Path, robot: str, *, same: bool
) -> None:
    assert header(tmp_path, robot) == (0, "")
    assert (contract_in(tmp_path / "contract.h") == CONTRACT) is same


@pytest.mark.parametrize(
    ("original", "replacement", "same"),
    [
        ('doc = "motors are off"', 'doc = "switch the motors on first"', True),
        ('count = 3, unit = "microstep", doc', 'count = 3, unit = "step", doc', False),
        ("reply_timeout = { value = 100", "reply_timeout = { value = 101", False),
    ],
)
def test_only_explanations_can_change_without_changing_the_contract(
    tmp_path: Path, original: str, replacement: str, *, same: bool
) -> None:
    schemas = copytree(SCHEMAS, tmp_path / "schemas")
    text = (schemas / "serial.toml").read_text(encoding="utf-8")
    assert original in text
    (schemas / "serial.toml").write_text(text.replace(original, replacement), encoding="utf-8")
    command = [sys.executable, str(schemas / "generate.py"), "--header", str(tmp_path / "contract.h")]
    subprocess.run(command, check=True, timeout=30)
    assert (contract_in(tmp_path / "contract.h") == CONTRACT) is same


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        ("[drives]\nmicrosteps = 16", r"'drives' is not a table; the tables are geometry, drive"),
        ("[drive]\nmicrostep = 16", r"\[drive\] has no 'microstep'; its fields are full_steps, microsteps"),
        ("[drive]\nmicrosteps = 'many'", r"\[drive\] microsteps = 'many': give a number above 0"),
        ("[drive]\nmicrosteps = 0", r"microsteps = 0: give a number above 0"),
        ("[drive]\nmicrosteps = 64", r"microsteps = 64: drivers support 1, 2, 4, 8, 16, 32"),
        (
            "[limits]\nspeed_max = 9000",
            r"speed_max: with this gear and these microsteps a frame can hold up to 1409 deg/s",
        ),
        ("[limits]\nacceleration = inf", r"other\.toml: cannot convert float infinity"),
        ("[drive\n", r"other\.toml: Expected ']'"),
    ],
)
def test_an_invalid_file_is_reported_with_the_allowed_values(tmp_path: Path, robot: str, why: str) -> None:
    code, errors = header(tmp_path, robot)
    assert code == 2
    assert re.search(why, errors), errors
