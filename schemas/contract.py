"""Read the contract's TOML files: what every emitter starts from."""

from __future__ import annotations

import hashlib
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

SCHEMAS = Path(__file__).resolve().parent
ROOT = SCHEMAS.parent

Table = dict[str, dict[str, object]]


@dataclass(frozen=True)
class Contract:
    """The four tables as read, and the hashes that two sides compare.

    `bus_hash` covers messages and keys, `serial_hash` the link to the firmware.
    """

    messages: dict[str, Table]
    keys: Table
    serial: dict[str, Table]
    robot: Table
    bus_hash: int
    serial_hash: int


def digest(*tables: object) -> int:
    """First 32 bits of the SHA-256 of the tables as canonical JSON: comments do not count."""
    text = json.dumps(tables, sort_keys=True, separators=(",", ":"))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def load(robot_file: Path = SCHEMAS / "robot.toml") -> Contract:
    """Read schemas/*.toml, or another robot's file."""
    files = [SCHEMAS / f"{name}.toml" for name in ("messages", "keys", "serial")]
    messages, keys, serial, robot = (
        tomllib.loads(path.read_text(encoding="utf-8")) for path in (*files, robot_file)
    )
    return Contract(messages, keys, serial, robot, digest(messages, keys), digest(serial))


def rows(table: dict[str, object]) -> dict[str, dict[str, object]]:
    """The entries of a table that are rows, in file order, without `doc` and flags."""
    return {name: row for name, row in table.items() if isinstance(row, dict)}
