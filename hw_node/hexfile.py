"""Intel HEX: what a compiler makes for a programmer."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import WrongUsage, quoted

BLANK = 0xFF
"""What erased flash reads as."""
DATA, END, SEGMENT, START_SEGMENT, HIGH, START = range(6)
SHORTEST = 5


def read(path: Path) -> bytes:
    """The image from address 0 on, gaps blank.

    Raises:
        WrongUsage: BAD_VALUE, naming the line that is wrong.
    """
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{path} cannot be read as Intel HEX: {error}.") from error
    image = bytearray()
    base = 0
    for number, line in enumerate(filter(None, map(str.strip, lines)), start=1):
        kind, at, data = record(path, number, line)
        if kind == DATA:
            begin = base + at
            if len(image) < begin + len(data):
                image.extend(bytes([BLANK]) * (begin + len(data) - len(image)))
            image[begin : begin + len(data)] = data
        elif kind == SEGMENT:
            base = int.from_bytes(data, "big") << 4
        elif kind == HIGH:
            base = int.from_bytes(data, "big") << 16
        elif kind == END:
            return bytes(image)
    raise WrongUsage(Reason.BAD_VALUE, f"{path} ends without an end record: it was cut off.")


def record(path: Path, number: int, line: str) -> tuple[int, int, bytes]:
    """Kind, address and data of one line; raises as `read`."""
    try:
        record = bytes.fromhex(line.removeprefix(":"))
    except ValueError:
        record = b""
    if (
        not line.startswith(":")
        or len(record) < SHORTEST
        or len(record) != SHORTEST + record[0]
        or sum(record) & 0xFF
    ):
        raise WrongUsage(
            Reason.BAD_VALUE, f"{path}, line {number} is no record of Intel HEX: {quoted(line)}."
        )
    return record[3], int.from_bytes(record[1:3], "big"), record[4:-1]
