"""WAV files: their format by its true name, and their samples.

The header is read here, because the module `wave` of Python 3.11 calls a 16-bit file with an extensible header damaged.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

import numpy as np
import numpy.typing as npt

PCM, FLOAT, EXTENSIBLE = 1, 3, 0xFFFE
NAMES: Final = {PCM: "whole numbers", FLOAT: "floating-point numbers", 6: "A-law", 7: "µ-law", 0x55: "MP3"}
BITS: Final = {PCM: (16, 24, 32), FLOAT: (32, 64)}
"""Formats that are read."""
READABLE: Final = "whole numbers of 16, 24 or 32 bits, or floating-point numbers of 32 or 64 bits"
FORMAT: Final = struct.Struct("<HHIIHH")
SUBFORMAT_AT: Final = 24
"""Place of the format in an extensible header."""
LONGEST: Final = 40
"""Length of the longest format, the extensible one."""
NO_WAV: Final = "it is no WAV file, or its header is damaged"


class Wav(NamedTuple):
    """The sound of a WAV file."""

    samples: npt.NDArray[np.int16]
    """(frames, channels)"""
    rate: int
    """frames per second"""


def _find_sound(file: BinaryIO) -> tuple[bytes, int]:
    """Read a file up to its samples; return the format and the number of bytes; raises ValueError."""
    head, header = file.read(12), b""
    if head[:4] != b"RIFF" or head[8:] != b"WAVE":
        raise ValueError(NO_WAV)
    while (name := file.read(4)) != b"data":
        size = int.from_bytes(file.read(4), "little")
        if not name:
            raise ValueError("it contains no sound" if len(header) >= FORMAT.size else NO_WAV)
        end = file.tell() + size + size % 2
        header = file.read(min(size, LONGEST)) if name == b"fmt " else header
        file.seek(end)
    if len(header) < FORMAT.size:
        raise ValueError(NO_WAV)
    return header, int.from_bytes(file.read(4), "little")


def read(path: Path, longest_s: float = float("inf")) -> Wav:
    """Read a WAV file of at most `longest_s` (s) as 16-bit numbers.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is no WAV file, or has another format; the message completes a sentence about the file.
    """
    with path.open("rb") as file:
        header, size = _find_sound(file)
        kind, channels, rate, _, width, bits = FORMAT.unpack_from(header)
        if kind == EXTENSIBLE and len(header) >= SUBFORMAT_AT + 2:
            (kind,) = struct.unpack_from("<H", header, SUBFORMAT_AT)
        if bits not in BITS.get(kind, ()):
            raise ValueError(f"it has {NAMES.get(kind, f'sound of format {kind}')} of {bits} bits")
        if not rate or not channels or width != channels * bits // 8:
            raise ValueError(NO_WAV)
        if not size:
            raise ValueError("it contains no sound")
        if size > longest_s * rate * width:
            raise ValueError(f"it lasts {size / (rate * width):.1f} s")
        if size % width or size > path.stat().st_size:
            raise ValueError("it ends before its sound does")
        data = file.read(size)
    if len(data) != size:
        raise ValueError("it ends before its sound does")
    if kind == PCM:  # the highest 16 bits of each number
        numbers = np.frombuffer(data, np.uint8).reshape(-1, bits // 8)[:, -2:]
        samples = np.ascontiguousarray(numbers).view("<i2")
    else:
        loud = np.clip(np.nan_to_num(np.frombuffer(data, f"<f{bits // 8}")), -1.0, 1.0) * 32768.0
        samples = np.minimum(np.rint(loud), 32767.0).astype("<i2")
    return Wav(samples.reshape(-1, channels), rate)
