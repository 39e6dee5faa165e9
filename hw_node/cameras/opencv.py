"""USB cameras on Windows and macOS, by their number. Only this module imports OpenCV."""

from __future__ import annotations

import contextlib
import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from types import ModuleType
from typing import Final, cast

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras.jpeg import HEIGHT, HZ, WIDTH

Pixels = NDArray[np.uint8]
"""Height x width x 3: blue, green, red."""

QUALITY: Final = 80
KEPT: Final = 2
"""Length of the queue of pictures; older ones are dropped."""
OPEN_S: Final = 10.0
"""Longest wait for a camera to open: drivers of Windows need several seconds."""
END_S: Final = 1.0
PAUSE_S: Final = 0.05
"""Pause (s) between attempts to read the first picture, if the driver fails at once instead of waiting."""


def library() -> ModuleType:
    """Import OpenCV without log output, which it would print every second while a camera is missing."""
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    import cv2  # noqa: PLC0415 - it reads the log level during its import

    return cast("ModuleType", cv2)


class OpenCvCamera:
    """A USB camera by its number: OpenCV decodes its pictures, and this class encodes them as JPEG."""

    name: Final = "opencv"

    def __init__(self, number: int, opencv: ModuleType) -> None:
        self._number, self._opencv = number, opencv
        self._reader: Reader | None = None

    def trouble(self) -> str:
        """Return an empty text: OpenCV cannot check for a camera without opening it."""
        return ""

    def open(self) -> None:
        """Start a thread that takes pictures, whose errors `next` raises; raises NoAnswer if the driver blocks."""
        if self._reader is not None and self._reader.thread.is_alive():
            raise self._stuck()
        self._reader = Reader(self._number, self._opencv)
        if not self._reader.begun.wait(OPEN_S):
            raise self._stuck()

    def next(self, timeout_s: float) -> CameraFrame | None:
        """Return the next picture; None if none arrives within `timeout_s`.

        Its time is that of its arrival, because OpenCV does not report the time of exposure.
        """
        if self._reader is None:
            return None
        try:
            taken = self._reader.pictures.get(timeout=timeout_s)
        except queue.Empty:
            return None
        if isinstance(taken, Exception):
            raise taken
        pixels, t_mono_ns = taken
        jpeg = simplejpeg.encode_jpeg(pixels, quality=QUALITY, colorspace="BGR", colorsubsampling="420")
        height, width = pixels.shape[:2]
        return CameraFrame(jpeg, width, height, t_mono_ns, self.name)

    def close(self) -> None:
        """Release the camera; if its driver blocks, this happens later, and `open` fails until then."""
        if self._reader is not None and self._reader.end():
            self._reader = None

    def _stuck(self) -> NoAnswer:
        return NoAnswer(
            Reason.TIMED_OUT,
            f"Camera {self._number} blocks its driver: unplug it, and plug it in again. If that does not help, restart `beatrix hw`.",
        )


class Reader:
    """A camera and its thread, which opens, reads and releases it: Windows requires one thread for all three."""

    def __init__(self, number: int, opencv: ModuleType) -> None:
        self._number, self._opencv = number, opencv
        self.pictures: queue.Queue[tuple[Pixels, int] | Exception] = queue.Queue(KEPT)
        """Pictures with their time (monotonic, ns); an exception is the last item."""
        self.begun = threading.Event()
        """Set when the camera has been opened, or has failed."""
        self._ended = threading.Event()
        self.thread = threads.start(self._run, f"opencv-{number}")

    def end(self) -> bool:
        """End the thread; return False if a call of OpenCV blocks it."""
        self._ended.set()
        self.thread.join(END_S)
        return not self.thread.is_alive()

    def _run(self) -> None:
        try:
            cv = self._opencv
            # These backends open cameras fast, and report when they are unplugged.
            backend = {"win32": cv.CAP_DSHOW, "darwin": cv.CAP_AVFOUNDATION}.get(sys.platform, cv.CAP_ANY)
            capture = cv.VideoCapture(self._number, backend)
            try:
                if not capture.isOpened():
                    raise NoAnswer(Reason.FAULT, missing(self._number))
                # Without motion JPEG a USB bus has no bandwidth for two cameras; a driver may ignore this.
                capture.set(cv.CAP_PROP_FOURCC, int.from_bytes(b"MJPG", "little"))
                capture.set(cv.CAP_PROP_FRAME_WIDTH, WIDTH)
                capture.set(cv.CAP_PROP_FRAME_HEIGHT, HEIGHT)
                capture.set(cv.CAP_PROP_FPS, HZ)
                self.begun.set()
                self._take(lambda: capture.read()[1])
            finally:
                capture.release()
        except Exception as error:  # noqa: BLE001 - `next` raises it in the thread that calls it
            self._put(error)
        finally:
            self.begun.set()

    def _take(self, read: Callable[[], Pixels | None]) -> None:
        """Take pictures until `end` is called; raises NoAnswer if the camera stops delivering them."""
        delivered = False
        while not self._ended.is_set():
            pixels = read()
            if pixels is not None:
                delivered = True
                self._put((pixels, time.monotonic_ns()))
            elif delivered:
                raise NoAnswer(Reason.FAULT, missing(self._number))
            else:  # some cameras need seconds for their first picture
                self._ended.wait(PAUSE_S)

    def _put(self, one: tuple[Pixels, int] | Exception) -> None:
        while self.pictures.full():
            with contextlib.suppress(queue.Empty):  # `next` has taken the picture
                self.pictures.get_nowait()
        self.pictures.put(one)  # does not wait, because only this thread puts


def missing(number: int) -> str:
    """Return the message, with all possible reasons, for a camera that fails: OpenCV does not report the reason."""
    permission = {
        "darwin": "macOS does not allow this terminal to use it (System Settings, Privacy & Security, Camera)",
        "win32": "Windows does not allow programs to use it (Settings, Privacy & security, Camera)",
    }.get(sys.platform, "this user may not use it")
    return f"Camera {number} cannot be read: it is not plugged in, another program uses it, or {permission}. The node retries every second."
