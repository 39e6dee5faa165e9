"""Read the TOML files of the contract, the input of every emitter."""

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
"""Microsteps per step that drivers support. A DRV8825 supports all of them, an A4988 all but 32."""

SPEED_TOP = 2**16 - 1
"""Highest speed that fits into a frame, in quarter microsteps per second: the speeds of MOVE are u16."""

SHOWN = ("doc", "group", "title", "decimals")
"""Entries of a row that say how programs show it, and change no message."""

Table = dict[str, dict[str, object]]


@dataclass(frozen=True)
class Contract:
    """The four tables, and the hashes by which two programs check that their contracts are equal.

    `bus_hash` covers messages and keys, `serial_hash` the serial link and the values compiled into the firmware.
    """

    messages: dict[str, Table]
    keys: Table
    serial: dict[str, Table]
    robot: Table
    bus_hash: int
    serial_hash: int


def digest(*tables: object) -> int:
    """Return the first 32 bits of the SHA-256 of the tables as canonical JSON, without comments and the entries SHOWN.

    A better explanation must not require every board to be flashed again. A field with a new meaning gets a new name.
    """
    text = json.dumps(bare(tables), sort_keys=True, separators=(",", ":"))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def names_of(enums: Table) -> dict[str, list[str]]:
    """Return the names of the values of each enumeration."""
    return {enum: [name for name in table if name != "doc"] for enum, table in enums.items()}


def bare(value: object) -> object:
    """Return a nested value without the entries SHOWN of its tables; tuples become lists."""
    if isinstance(value, dict):
        # A table of such a name is a field of a message, such as the title of a note.
        kept = {name: entry for name, entry in value.items() if name not in SHOWN or isinstance(entry, dict)}
        return {name: bare(entry) for name, entry in kept.items()}
    return [bare(entry) for entry in value] if isinstance(value, list | tuple) else value


def load(robot_file: Path | None = None) -> Contract:
    """Read schemas/*.toml; values of `robot_file` (`[drive]`, `microsteps = 16`) replace those of robot.toml.

    Raises:
        ValueError: `robot_file` is not TOML, or has an unknown name or an impossible value.
        OverflowError: a value is infinite.
        OSError: `robot_file` cannot be read.
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
            f"[drive] microsteps = {microsteps!r}: drivers support {allowed} (an A4988 up to 16)"
        )
    in_firmware = compiled(robot)
    if (speed := in_firmware["SPEED_MAX"]) > SPEED_TOP:
        most = robot["limits"]["speed_max"]["value"] * SPEED_TOP // speed
        raise ValueError(
            f"[limits] speed_max: with this gear and these microsteps a frame can hold up to {most:g} deg/s"
        )
    named = {**messages, "enum": names_of(messages["enum"])}
    return Contract(messages, keys, serial, robot, digest(named, keys), digest(serial, in_firmware))


def change(robot: Table, given: dict[str, object]) -> None:
    """Replace values of the robot; raises ValueError for an unknown table or field, or no number above 0."""
    for table, values in given.items():
        if table not in robot or not isinstance(values, dict):
            raise ValueError(f"{table!r} is not a table; the tables are {', '.join(robot)}")
        known = rows(robot[table])
        for name, value in values.items():
            if name not in known:
                raise ValueError(f"[{table}] has no {name!r}; its fields are {', '.join(known)}")
            if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0:
                raise ValueError(f"[{table}] {name} = {value!r}: give a number above 0")
            known[name]["value"] = value


def rows(table: dict[str, object]) -> dict[str, dict[str, object]]:
    """Return the entries of a table that are rows, in file order, without `doc` and flags."""
    return {name: row for name, row in table.items() if isinstance(row, dict)}
