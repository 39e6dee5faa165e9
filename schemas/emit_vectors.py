"""Golden bytes: schemas/vectors/*.json, made from examples by the encoders of golden_bytes.py.

Each message has two examples: one with all its fields, and one without those that may be missing.
"""

from __future__ import annotations

import itertools
import json
import struct
from collections.abc import Iterator

from contract import Contract, rows
from golden_bytes import cobs, crc16, msgpack, payload

Value = dict[str, object]

NUMBERS: dict[str, tuple[object, ...]] = {
    "bool": (True, False),
    "float32": (0.5, -0.125, 0.0, 0.1),
    "int16": (1, -2, 127, -32768),
    "int32": (-129, 70000, 0, -(2**31)),
    "int64": (123456789012345, 1700000000123456789),
    "uint16": (640, 255, 65535, 7),
    "uint32": (70000, 2**32 - 1, 128, 0),
}
"""Examples of numbers, of every length that MessagePack has for them."""
TEXTS = {
    "name": ("ana", "bea"),
    "label": ("1.2.3", "TILT"),
    "string": ("", "Die Motoren sind aus – ✓", "x" * 40),
}

FRAMES: list[tuple[str, int, Value]] = [
    ("HELLO", 1, {}),
    ("PING", 255, {}),
    ("MOVE", 7, {"motion": 513, "target": [100, -200, 32767], "speed": [1400, 1, 65535]}),
    ("MOVE", 0, {"motion": 0, "target": [0, 0, 0], "speed": [256, 256, 256]}),
    ("MOVE_STRAIGHT", 8, {"motion": 514, "target": [0, -32768, 7], "speed": 1400}),
    ("STOP", 3, {}),
    ("EMERGENCY_STOP", 4, {}),
    ("ENABLE", 5, {"value": 1}),
    ("CALIBRATE", 6, {}),
    ("SET_NAME", 9, {"name": "bea1"}),
    ("TEXT_OPEN", 10, {}),
    ("RESET", 11, {}),
]


class Examples:
    """Makes examples of messages; the values of each type follow each other."""

    def __init__(self, contract: Contract) -> None:
        names = {name: [*table][1:] for name, table in contract.messages["enum"].items()}  # without `doc`
        self._values = {kind: itertools.cycle(found) for kind, found in {**NUMBERS, **TEXTS, **names}.items()}
        self._messages = contract.messages["message"]

    def all(self) -> Iterator[tuple[str, Value]]:
        """Yield two examples of each message with its name."""
        for name in self._messages:
            yield name, self._message(name, full=True)
            yield name, self._message(name, full=False)

    def _message(self, name: str, *, full: bool) -> Value:
        table = rows(self._messages[name])
        return {str(row.get("wire", field)): self._field(row, full=full) for field, row in table.items()}

    def _field(self, row: Value, *, full: bool) -> object:
        kind = str(row["type"])
        if not full and (row.get("optional") or "default" in row):
            return row.get("default")
        if row.get("list"):
            return [self._value(kind, full=full) for _ in range(2 * full)]
        return self._value(kind, full=full)

    def _value(self, kind: str, *, full: bool) -> object:
        return self._message(kind, full=full) if kind in self._messages else next(self._values[kind])


def files(contract: Contract) -> dict[str, str]:
    """Return the text of every file of golden bytes by its relative path."""
    messages = [
        {"message": name, "value": value, "msgpack": msgpack(value).hex()}
        for name, value in Examples(contract).all()
    ]
    frames = []
    for name, seq, values in FRAMES:
        body = bytes([int(str(contract.serial["frame"][name]["type"])), seq]) + payload(
            contract, name, values
        )
        wire = b"\0" + cobs(body + struct.pack("<H", crc16(body))) + b"\0"
        frames.append({"frame": name, "seq": seq, "fields": values, "wire": wire.hex()})
    return {
        "schemas/vectors/messages.json": json.dumps(messages, indent=1, ensure_ascii=False) + "\n",
        "schemas/vectors/serial.json": json.dumps(frames, indent=1) + "\n",
    }
