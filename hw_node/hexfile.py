"""Reader for Intel HEX, the format of firmware images."""

from __future__ import annotations

import codecs
from binascii import unhexlify
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from beatrix_zenoh import files
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted
from hw_node.stk500 import FLASH

BLANK = 0xFF
"""Value of erased flash."""
DATA, END, SEGMENT, START_SEGMENT, HIGH, START = range(6)
LENGTHS = {END: 0, SEGMENT: 2, START_SEGMENT: 4, HIGH: 2, START: 4}
"""Number of bytes in a record of each kind. Start addresses (START_SEGMENT, START) have no use on an AVR."""
SHORTEST = 5
LONGEST_FILE = 4 << 20
"""Largest size of a file (bytes): more than an image of the whole flash with one byte in each line."""


class Piece(NamedTuple):
    """The data of one line."""

    at: int
    data: bytes
    line: int


def read(path: Path) -> bytes:
    """Return the image from address 0 on, 1 to FLASH bytes; gaps are BLANK.

    Raises:
        WrongUsage: BAD_VALUE, the file is missing, or not an image for this board. The message names the invalid line.
    """
    found = sorted(piece for piece in pieces(path) if piece.data)
    if not found:
        raise WrongUsage(Reason.BAD_VALUE, f"{path} contains no data.")
    if found[0].at:
        raise wrong(
            path,
            found[0].line,
            f"has the lowest address, {found[0].at:#x}; the image must begin at address 0",
        )
    for before, after in pairwise(found):
        if before.at + len(before.data) > after.at:
            first, again = sorted((before.line, after.line))
            raise wrong(path, again, f"overlaps line {first}")
    image = bytearray()
    for at, data, _ in found:
        image += bytes([BLANK]) * (at - len(image)) + data
    return bytes(image)


def pieces(path: Path) -> list[Piece]:
    """Return the data of all lines, in file order; raises the errors of `read`."""
    found = []
    base = number = 0
    ended = False
    for number, line in enumerate(map(bytes.strip, content(path).splitlines()), start=1):
        if not line:
            continue
        if ended:
            raise wrong(path, number, "comes after the end record")
        kind, at, data = record(path, number, line)
        if kind == DATA and base + at + len(data) > FLASH:
            raise wrong(path, number, f"ends at {base + at + len(data):#x}; the flash ends at {FLASH:#x}")
        if kind == DATA:
            found.append(Piece(base + at, data, number))
        elif kind in (SEGMENT, HIGH):
            base = int.from_bytes(data, "big") << (4 if kind == SEGMENT else 16)
        ended = kind == END
    if not ended:
        raise WrongUsage(Reason.BAD_VALUE, f"{path} has no end record after line {number}: it is incomplete.")
    return found


def content(path: Path) -> bytes:
    """Return the whole file without a byte order mark; raises the errors of `read`."""
    try:
        held = files.content(path, LONGEST_FILE, "Intel HEX")
    except OSError as error:
        raise WrongUsage(Reason.BAD_VALUE, f"{path} cannot be read: {error.strerror}.") from error
    return held.removeprefix(codecs.BOM_UTF8)


def record(path: Path, number: int, line: bytes) -> tuple[int, int, bytes]:
    """Return kind, address and data of one line; raises the errors of `read`."""
    try:
        record = unhexlify(line.removeprefix(b":"))
    except ValueError:
        record = b""
    if (
        not line.startswith(b":")
        or len(record) < SHORTEST
        or len(record) != SHORTEST + record[0]
        or sum(record) & 0xFF
    ):
        raise wrong(path, number, f"is not a record of Intel HEX: {quoted(line.decode(errors='replace'))}")
    kind, data = record[3], record[4:-1]
    if kind != DATA and LENGTHS.get(kind) != len(data):
        raise wrong(path, number, f"has an unknown kind of record: kind {kind} with {len(data)} bytes")
    return kind, int.from_bytes(record[1:3], "big"), data


def wrong(path: Path, number: int, why: str) -> WrongUsage:
    """Return the error for a line."""
    return WrongUsage(Reason.BAD_VALUE, f"{path}, line {number} {why}.")
