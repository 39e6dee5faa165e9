"""The pictures of cameras: the format that is requested, and the segments of JPEG files.

Segments (size, tables) and the pictures of a stream are read without decoding.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Final, NamedTuple

import numpy as np
import simplejpeg

WIDTH, HEIGHT, HZ = 640, 480, 30
"""Format requested from cameras: pixels, and pictures a second."""
SOI, EOI = b"\xff\xd8", b"\xff\xd9"
START = SOI + b"\xff"
"""Begin of a picture among other data, which may have the two bytes of SOI by chance."""
DHT, SOS = 0xC4, 0xDA
SIZES: Final = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of the segments that contain the size (SOFn; ITU T.81, table B.1)."""


class Segment(NamedTuple):
    """A segment of a picture's header: marker, begin and end."""

    marker: int
    begin: int
    end: int


def segments(picture: bytes, at: int = 0) -> Iterator[Segment]:
    """Yield the header segments of the picture at `at`, up to its data; raises ValueError if the header is invalid."""
    if picture[at : at + 2] != SOI:
        raise ValueError("it is not a JPEG picture")
    at += 2
    while at + 4 <= len(picture) and picture[at] == 0xFF:
        marker, end = picture[at + 1], at + 2 + int.from_bytes(picture[at + 2 : at + 4], "big")
        if marker == 0xFF:  # a fill byte
            at += 1
            continue
        if end > len(picture):
            break
        yield Segment(marker, at, end)
        if marker == SOS:
            return
        at = end
    raise ValueError("its header is damaged")


def size(picture: bytes) -> tuple[int, int]:
    """Return width and height in pixels; raises ValueError if it is not a JPEG picture."""
    for marker, begin, _ in segments(picture):
        if marker in SIZES:
            height, width = (int.from_bytes(picture[begin + n : begin + n + 2], "big") for n in (5, 7))
            return width, height
    raise ValueError("it has no size")


def complete(picture: bytes) -> bytes:
    """Add the standard Huffman tables, which a JPEG file must have and cameras omit.

    A picture that has tables is returned unchanged. Raises ValueError if it is not a whole JPEG picture.
    """
    head = list(segments(picture))
    if EOI not in picture[head[-1].end :]:
        raise ValueError("it is damaged: its end is missing")
    if any(segment.marker == DHT for segment in head):
        return picture
    at = head[-1].begin
    return b"".join((picture[:at], standard_tables(), picture[at:]))


@cache
def standard_tables() -> bytes:
    """Return the Huffman tables of ITU T.81, annex K.3, which the encoder writes into every colour picture."""
    picture = simplejpeg.encode_jpeg(np.zeros((16, 16, 3), np.uint8), colorspace="RGB")
    return b"".join(picture[begin:end] for marker, begin, end in segments(picture) if marker == DHT)


def split(stream: bytes) -> Iterator[tuple[int, int]]:
    """Yield begin and end of each picture of a video in motion JPEG; raises ValueError if a header is damaged."""
    at = stream.find(START)
    while at >= 0:
        *_, last = segments(stream, at)
        end = stream.find(EOI, last.end)
        if end < 0:
            return  # the last picture is incomplete
        yield at, end + len(EOI)
        at = stream.find(START, end)
