"""Pictures without a camera: a test picture with number and time, or pictures from files."""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import SensorFrame, picture
from beatrix_zenoh.node.sensors import SensorSource
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
BARS_HEIGHT: Final = 360
BARS: Final = np.array([(k & 2, k & 4, k & 1) for k in (7, 6, 5, 4, 3, 2, 1)], bool).astype(np.uint8) * 192
"""Colours of the bars above, from white to blue; the right eye has them in reverse order."""


class TimedPictures(SensorSource):
    """A source that makes pictures at a constant rate."""

    _due_s, _period_s = 0.0, 1 / HZ

    def open(self) -> None:
        """Begin with the first picture now."""
        self._due_s = time.monotonic()

    def next(self, timeout_s: float) -> SensorFrame | None:
        """Wait for the next picture and return it; None if it is due after `timeout_s`."""
        left_s = self._due_s - time.monotonic()
        time.sleep(max(0.0, min(left_s, timeout_s)))
        if left_s > timeout_s:
            return None
        # Missed deadlines are skipped, so that no burst of late pictures follows a delay.
        self._due_s = max(self._due_s + self._period_s, time.monotonic())
        return self.picture(time.monotonic_ns())

    @abstractmethod
    def picture(self, t_mono_ns: int) -> SensorFrame:
        """Return the picture of this time; raises NoAnswer if there is none."""


class Pattern(TimedPictures):
    """Test pictures at 30 Hz with their number since the start, and the monotonic time in ms, as blocks."""

    name = "pattern"

    def __init__(self, eye: str) -> None:
        self._number = 0
        self._image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        bars = BARS if eye == "left" else BARS[::-1]
        self._image[:BARS_HEIGHT] = bars.repeat(-(-WIDTH // len(bars)), axis=0)[:WIDTH]

    def picture(self, t_mono_ns: int) -> SensorFrame:
        """Draw the next picture."""
        self._number += 1
        self._code(NUMBER_Y, self._number)
        self._code(TIME_Y, t_mono_ns // 1_000_000)
        jpeg = simplejpeg.encode_jpeg(self._image, quality=QUALITY, colorspace="RGB", colorsubsampling="420")
        return picture(jpeg, WIDTH, HEIGHT, t_mono_ns, self.name)

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
KINDS: Final = f"a folder of {' or '.join(PICTURES)} files, or one such file"


class PictureFiles(TimedPictures):
    """The pictures of a folder in the order of their names, or one picture: repeated, 30 a second, not encoded again."""

    name = "file"

    def __init__(self, path: Path) -> None:
        self._path, self._next = path, 0
        self._pictures: Sequence[Path] = ()

    def trouble(self) -> str:
        """Return an error message if the path does not exist, else an empty text."""
        return "" if self._path.exists() else f"{self._path} does not exist. Name {KINDS}."

    def open(self) -> None:
        """Find the pictures, and begin with the first one now."""
        self._pictures = [self._path]
        if self._path.is_dir():
            self._pictures = sorted(p for p in self._path.iterdir() if p.suffix.lower() in PICTURES)
        if not self._pictures:
            raise self._unreadable(self._path, "it contains no JPEG picture")
        super().open()

    def picture(self, t_mono_ns: int) -> SensorFrame:
        """Return the next picture."""
        path = self._pictures[self._next % len(self._pictures)]
        self._next += 1
        try:
            whole = jpeg.complete(path.read_bytes())
            height, width, *_ = simplejpeg.decode_jpeg_header(whole)
        except (OSError, ValueError) as error:
            raise self._unreadable(path, str(error)) from error
        return picture(whole, width, height, t_mono_ns, self.name)

    @staticmethod
    def _unreadable(path: Path, why: str) -> NoAnswer:
        return NoAnswer(Reason.BAD_VALUE, f"{path} cannot be shown: {why}. Name {KINDS}.")
