"""A lab's own robot: a TOML file whose values take the place of the shipped ones."""

from __future__ import annotations

import tomllib
from pathlib import Path

import msgspec

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh.errors import WrongUsage, quoted

COMPILED = {
    "drive": {"full_steps", "microsteps", "gear_pinion", "gear_ring", "sign"},
    "limits": {
        "guard_gap_min",
        "guard_yaw_max",
        "tilt_gap_min",
        "tilt_gap_max",
        "text_speed",
        "acceleration",
    },
    "pins": {"step", "dir", "enable"},
}
"""What the firmware counts with: other values here would make its guard wrong."""


def load(path: Path | None) -> RobotData:
    """The shipped robot, with the values of this file if there is one: tables and names as in docs/reference/robot.md.

    Raises:
        WrongUsage: BAD_VALUE, naming what is wrong and what there is.
    """
    if path is None:
        return ROBOT
    try:
        given = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise WrongUsage(Reason.BAD_VALUE, f"--robot-file {path} cannot be read: {error}.") from error
    tables: dict[str, dict[str, object]] = msgspec.to_builtins(ROBOT)
    for name, values in given.items():
        if name not in tables or not isinstance(values, dict):
            raise WrongUsage(
                Reason.BAD_VALUE, f"{path}: {quoted(name)} is no table. There are: {', '.join(tables)}."
            )
        for field, value in values.items():
            check(path, name, field, tables[name])
            tables[name][field] = value
    try:
        return msgspec.convert(tables, RobotData)
    except msgspec.ValidationError as error:
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path}: {error}. Values and units: docs/reference/robot.md."
        ) from error


def check(path: Path, table: str, field: str, known: dict[str, object]) -> None:
    """Refuse a field that is not there, or that the firmware was compiled with; raises as `load`."""
    if field not in known:
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path}: [{table}] has no {quoted(field)}. There are: {', '.join(known)}."
        )
    if field in COMPILED.get(table, ()):
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"{path}: [{table}] {field} is compiled into the firmware. Change schemas/robot.toml, build and flash; if a "
            "motor only turns the wrong way, turn its plug round.",
        )
