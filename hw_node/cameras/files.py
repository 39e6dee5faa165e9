"""Pictures from files instead of a camera: a folder of JPEG files, a video in motion JPEG, or one picture."""

from __future__ import annotations

import mmap
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras import jpeg
from hw_node.cameras.source import HZ, FrameTimer

PICTURES: Final = (".jpg", ".jpeg")
VIDEOS: Final = (".avi", ".mjpeg", ".mjpg")
KINDS: Final = f"a folder of {' or '.join(PICTURES)} files, or a video in motion JPEG ({', '.join(VIDEOS)})"
LISTS: Final = (b"RIFF", b"LIST")
US: Final = 1_000_000
HZ_MAX: Final = 60.0

Range = tuple[int, int]


class Files:
    """The pictures of a folder in the order of their names, or those of a video, or one picture.

    They are repeated, and not encoded again. The rate is 30 pictures a second, or that of an AVI video, at most HZ_MAX.
    """

    name: Final = "file"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._pictures: Sequence[Path | Range] = ()
        self._video: mmap.mmap | None = None
        self._next = 0
        self._timer = FrameTimer()

    def trouble(self) -> str:
        """Return an error message if the path does not exist, else an empty text."""
        return "" if self._path.exists() else f"{self._path} does not exist. Name {KINDS}."

    def open(self) -> None:
        """Find the pictures and start their timer."""
        try:
            hz = self._open()
        except (OSError, ValueError) as error:
            raise self._unreadable(str(error)) from error
        if not self._pictures:
            raise self._unreadable("it contains no JPEG picture")
        self._timer = FrameTimer(hz)

    def _open(self) -> float:
        """Find the pictures, and return their rate (Hz)."""
        if self._path.is_dir():
            self._pictures = sorted(p for p in self._path.iterdir() if p.suffix.lower() in PICTURES)
            return HZ
        if self._path.suffix.lower() in PICTURES:
            self._pictures = [self._path]
            return HZ
        with self._path.open("rb") as video:
            self._video = mmap.mmap(video.fileno(), 0, access=mmap.ACCESS_READ)
        if self._video[:4] != b"RIFF":
            self._pictures = list(jpeg.split(self._video))
            return HZ
        self._pictures, hz = avi(self._video)
        return hz

    def next(self, timeout_s: float) -> CameraFrame | None:
        """Wait for the next picture and return it; None if it is due after `timeout_s`."""
        if not self._timer.wait(timeout_s):
            return None
        one = self._pictures[self._next % len(self._pictures)]
        self._next += 1
        try:
            picture = jpeg.complete(self._read(one))
            width, height = jpeg.size(picture)
        except (OSError, ValueError) as error:
            raise self._unreadable(f"{one if isinstance(one, Path) else 'a picture'}: {error}") from error
        return CameraFrame(picture, width, height, time.monotonic_ns(), self.name)

    def _read(self, one: Path | Range) -> bytes:
        if isinstance(one, Path):
            return one.read_bytes()
        assert self._video is not None, "ranges belong to an open video"
        return self._video[slice(*one)]

    def _unreadable(self, why: str) -> NoAnswer:
        return NoAnswer(Reason.BAD_VALUE, f"{self._path} cannot be shown: {why}. Name {KINDS}.")

    def close(self) -> None:
        """Close the video if one is open."""
        if self._video is not None:
            self._video.close()
        self._video, self._pictures = None, ()


def avi(video: mmap.mmap) -> tuple[list[Range], float]:
    """Return the ranges of the pictures in an AVI video, and their rate (Hz).

    Raises ValueError if they are not motion JPEG.
    """
    pictures, hz = [], float(HZ)
    for kind, begin, end in chunks(video, 0, len(video)):
        if kind == b"avih":
            period_us = int.from_bytes(video[begin : begin + 4], "little")
            hz = min(HZ_MAX, US / period_us) if period_us else hz
        elif kind[2:] in (b"dc", b"db") and end > begin:
            pictures.append((begin, end))
    if pictures and video[pictures[0][0] : pictures[0][0] + 2] != jpeg.SOI:
        raise ValueError(
            "its pictures are not motion JPEG; `ffmpeg -i VIDEO -c:v mjpeg OTHER.avi` converts them"
        )
    return pictures, hz


def chunks(video: mmap.mmap, at: int, end: int) -> Iterator[tuple[bytes, int, int]]:
    """Yield name, begin and end of all data chunks of a RIFF file."""
    while at + 8 <= end:
        kind = video[at : at + 4]
        length = int.from_bytes(video[at + 4 : at + 8], "little")
        begin, stop = at + 8, min(end, at + 8 + length)
        if kind in LISTS:
            yield from chunks(video, begin + 4, stop)
        else:
            yield kind, begin, stop
        at = begin + length + length % 2
