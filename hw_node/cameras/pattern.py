"""A test picture that contains eye, number and time: for people as text, for programs as rows of blocks."""

from __future__ import annotations

import time
from typing import Final

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from beatrix_zenoh.lettering import cells
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras.source import HEIGHT, HZ, WIDTH, FrameTimer

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
