"""The pictures of cameras: the format that is requested, and the segments of JPEG files.

Segments are read without decoding.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
import simplejpeg

WIDTH, HEIGHT, HZ = 640, 480, 30
"""Format requested from cameras: pixels, and pictures a second."""
SOI, EOI = b"\xff\xd8", b"\xff\xd9"
DHT, SOS = 0xC4, 0xDA


class Segment(NamedTuple):
    """A segment of a picture's header: marker, begin and end."""

    marker: int
    begin: int
    end: int


def segments(picture: bytes) -> Iterator[Segment]:
    """Yield the header segments of a picture, up to its data; raises ValueError if the header is invalid."""
    if not picture.startswith(SOI):
        raise ValueError("it is not a JPEG picture")
    at = len(SOI)
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
