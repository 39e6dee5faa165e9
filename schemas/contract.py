"""Read the contract's TOML files: what every emitter starts from."""

from __future__ import annotations

import hashlib
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

from compiled import compiled

SCHEMAS = Path(__file__).resolve().parent
ROOT = SCHEMAS.parent

MICROSTEPS = (1, 2, 4, 8, 16, 32)
"""What drivers make of a step; the last a DRV8825, the others an A4988 as well."""

SPEED_TOP = 2**16 - 1
"""Quarter microsteps per second: a MOVE's speeds are u16."""

Table = dict[str, dict[str, object]]


@dataclass(frozen=True)
class Contract:
    """The four tables as read, and the hashes that two sides compare.

    `bus_hash` covers messages and keys, `serial_hash` the link to the firmware and what of the robot is compiled into it.
    """

    messages: dict[str, Table]
    keys: Table
    serial: dict[str, Table]
    robot: Table
    bus_hash: int
    serial_hash: int


def digest(*tables: object) -> int:
    """First 32 bits of the SHA-256 of the tables as canonical JSON, without comments and `doc`.

    A better word must not make every board be flashed again; whoever changes a meaning changes a name with it.
    """
    text = json.dumps(bare(tables), sort_keys=True, separators=(",", ":"))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def bare(value: object) -> object:
    """Tables, and what is in them, without `doc`."""
    if isinstance(value, dict):
        return {name: bare(entry) for name, entry in value.items() if name != "doc"}
    return [bare(entry) for entry in value] if isinstance(value, list | tuple) else value


def load(robot_file: Path | None = None) -> Contract:
    """Read schemas/*.toml; values in another robot's file (`[drive]`, `microsteps = 16`) take the place of those there.

    Raises:
        ValueError: that file is no TOML, or names what is not there, or what no driver can do.
        OSError: it cannot be read.
    """
    messages, keys, serial, robot = (
        tomllib.loads((SCHEMAS / f"{name}.toml").read_text(encoding="utf-8"))
        for name in ("messages", "keys", "serial", "robot")
    )
    if robot_file is not None:
        change(robot, tomllib.loads(robot_file.read_text(encoding="utf-8")))
    if (microsteps := robot["drive"]["microsteps"]["value"]) not in MICROSTEPS:
        allowed = ", ".join(map(str, MICROSTEPS))
        raise ValueError(
            f"[drive] microsteps = {microsteps!r}: jumpers can say {allowed} (an A4988 no more than 16)"
        )
    in_firmware = compiled(robot)
    if (speed := in_firmware["SPEED_MAX"]) > SPEED_TOP:
        most = robot["limits"]["speed_max"]["value"] * SPEED_TOP // speed
        raise ValueError(
            f"[limits] speed_max: with this gear and these microsteps a frame can say up to {most:g} deg/s"
        )
    return Contract(messages, keys, serial, robot, digest(messages, keys), digest(serial, in_firmware))


def change(robot: Table, given: dict[str, object]) -> None:
    """Put given values in their rows; raises ValueError as `load`."""
    for table, values in given.items():
        if table not in robot or not isinstance(values, dict):
            raise ValueError(f"{table!r} is no table; there are {', '.join(robot)}")
        there = rows(robot[table])
        for name, value in values.items():
            if name not in there:
                raise ValueError(f"[{table}] has no {name!r}; there are {', '.join(there)}")
            if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0:
                raise ValueError(f"[{table}] {name} = {value!r}: give a number above 0")
            there[name]["value"] = value


def rows(table: dict[str, object]) -> dict[str, dict[str, object]]:
    """The entries of a table that are rows, in file order, without `doc` and flags."""
    return {name: row for name, row in table.items() if isinstance(row, dict)}
