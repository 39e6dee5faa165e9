"""Pictures without a camera: a test picture with eye, number and time, or pictures and videos from files."""

from __future__ import annotations

import mmap
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.lettering import cells
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras import jpeg
from hw_node.cameras.jpeg import HEIGHT, HZ, WIDTH

Pixels = NDArray[np.uint8]
"""Height x width x 3: red, green, blue."""

QUALITY: Final = 80
BITS: Final = 32
BLOCK: Final = 16
"""Pixels; JPEG stores colours in squares of this size."""
BLOCKS_X: Final = (WIDTH - BITS * BLOCK) // 2
NUMBER_Y, TIME_Y = HEIGHT - 3 * BLOCK, HEIGHT - 2 * BLOCK
SWEEP_Y, SWEEP_HEIGHT, SWEEP_STEP = 112, 32, 8
TEXT_X, EYE_Y, CLOCK_Y = 104, 192, 272
SCALE: Final = 6
CHARACTERS: Final = " 0123456789.:EFGHILRT"
BARS: Final = (
    (192, 192, 192),
    (192, 192, 0),
    (0, 192, 192),
    (0, 192, 0),
    (192, 0, 192),
    (192, 0, 0),
    (0, 0, 192),
)


def letters() -> dict[str, Pixels]:
    """Return pictures of the letters, with a gap of one point to their right, white on black."""
    pictures = {}
    for letter in CHARACTERS:
        big = np.kron(cells(letter), np.ones((SCALE, SCALE), int)) * 255
        pictures[letter] = np.repeat(big[:, :, None], 3, axis=2).astype(np.uint8)
    return pictures


def background(eye: str) -> Pixels:
    """Return colour bars, in reverse order for the right eye, above a black field for text and blocks."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    order = BARS if eye == "left" else BARS[::-1]
    image[:SWEEP_Y] = np.repeat(np.array(order, np.uint8), -(-WIDTH // len(BARS)), axis=0)[:WIDTH]
    return image


class FrameTimer:
    """Absolute deadlines of pictures at a constant rate."""

    def __init__(self, hz: float = HZ) -> None:
        self._period_s = 1 / hz
        self._due_s = time.monotonic()

    def wait(self, timeout_s: float) -> bool:
        """Wait for the next deadline; return False after `timeout_s` if it is later."""
        left_s = self._due_s - time.monotonic()
        if left_s > timeout_s:
            time.sleep(timeout_s)
            return False
        if left_s > 0:
            time.sleep(left_s)
        # Missed deadlines are skipped, so that no burst of late pictures follows a delay.
        self._due_s = max(self._due_s + self._period_s, time.monotonic())
        return True


class Pattern:
    """Test pictures at 30 Hz with their number since the start, the wall-clock time, and the monotonic time in ms."""

    name: Final = "pattern"

    def __init__(self, eye: str) -> None:
        self._eye, self._number = eye, 0
        self._letters = letters()
        self._image = background(eye)
        self._timer = FrameTimer(HZ)

    def trouble(self) -> str:
        """Return an empty text: the test picture is always available."""
        return ""

    def open(self) -> None:
        """Restart the timer."""
        self._timer = FrameTimer(HZ)

    def next(self, timeout_s: float) -> CameraFrame | None:
        """Wait for the next picture and return it; None if it is due after `timeout_s`."""
        if not self._timer.wait(timeout_s):
            return None
        self._number += 1
        t_mono_ns = time.monotonic_ns()
        self._draw(t_mono_ns)
        jpeg = simplejpeg.encode_jpeg(self._image, quality=QUALITY, colorspace="RGB", colorsubsampling="420")
        return CameraFrame(jpeg, WIDTH, HEIGHT, t_mono_ns, self.name)

    def close(self) -> None:
        """Do nothing: there are no resources to free."""

    def _draw(self, t_mono_ns: int) -> None:
        """Draw the parts that change; the rest of the picture is constant."""
        wall_s, ms = divmod(time.time_ns() // 1_000_000, 1000)
        clock = time.strftime("%H:%M:%S", time.localtime(wall_s))
        self._write(EYE_Y, f"{self._eye.upper():<5}{self._number % 10**7:>7}")
        self._write(CLOCK_Y, f"{clock}.{ms:03d}")
        self._sweep()
        self._code(NUMBER_Y, self._number)
        self._code(TIME_Y, t_mono_ns // 1_000_000)

    def _write(self, y: int, text: str) -> None:
        line = np.concatenate([self._letters[letter] for letter in text], axis=1)
        self._image[y : y + line.shape[0], TEXT_X : TEXT_X + line.shape[1]] = line

    def _sweep(self) -> None:
        """Draw a bar that moves with every picture, so that people see whether pictures still arrive."""
        stripe = self._image[SWEEP_Y : SWEEP_Y + SWEEP_HEIGHT]
        stripe[:] = 32
        at = self._number * SWEEP_STEP % WIDTH
        stripe[:, at : at + SWEEP_STEP] = 255

    def _code(self, y: int, value: int) -> None:
        bits = (value >> np.arange(BITS - 1, -1, -1, dtype=np.int64) & 1).astype(np.uint8) * 255
        self._image[y : y + BLOCK, BLOCKS_X : WIDTH - BLOCKS_X] = np.repeat(bits, BLOCK)[None, :, None]


def number_and_time(image: Pixels) -> tuple[int, int]:
    """Return number and monotonic time (ms) from the blocks of a decoded picture, both modulo 2**32."""
    number, t_ms = (_value(image[y : y + BLOCK, BLOCKS_X : WIDTH - BLOCKS_X]) for y in (NUMBER_Y, TIME_Y))
    return number, t_ms


def _value(row: Pixels) -> int:
    means = row.reshape(BLOCK, BITS, BLOCK, 3).mean(axis=(0, 2, 3))
    return int("".join("1" if mean > 127 else "0" for mean in means), 2)


PICTURES: Final = (".jpg", ".jpeg")
VIDEOS: Final = (".avi", ".mjpeg", ".mjpg")
KINDS: Final = f"a folder of {' or '.join(PICTURES)} files, or a video in motion JPEG ({', '.join(VIDEOS)})"
LISTS: Final = (b"RIFF", b"LIST")
US: Final = 1_000_000
HZ_MAX: Final = 60.0

Range = tuple[int, int]


class PictureFiles:
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
