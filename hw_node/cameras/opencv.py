"""USB cameras, by their path on Linux or by their number. Only this module imports OpenCV."""

from __future__ import annotations

import logging
import os
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any, Final

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
"""Height x width x 3: blue, green, red; or the bytes of a JPEG picture."""

QUALITY: Final = 80
MOTION_JPEG: Final = int.from_bytes(b"MJPG", "little")
LOW_HZ: Final = 15
"""Pictures a second after an attempt without a picture: two cameras may not fit through one USB bus at HZ."""
READ_S: Final = 1
"""Longest wait (s) of a call of OpenCV for a picture, on Linux."""
PAUSE_S: Final = 0.05
"""A call that takes less time (s) has not waited for a picture; pause after it."""
AGE_NS: Final = 1_000_000_000
"""Largest age of a picture whose time is that of the driver; other drivers use another clock."""
BACKENDS: Final = {"win32": "CAP_DSHOW", "darwin": "CAP_AVFOUNDATION"}
"""OpenCV's names of the interfaces that open cameras fast, and report when they are unplugged; else V4L2."""
PERMISSION: Final = {
    "darwin": "macOS does not allow this terminal to use it (System Settings, Privacy & Security, Camera)",
    "win32": "Windows does not allow programs to use it (Settings, Privacy & security, Camera)",
}

log = logging.getLogger(__name__)


def library() -> ModuleType:
    """Import OpenCV without log output, which it would print every second while a camera is missing."""
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", str(READ_S))
    import cv2  # noqa: PLC0415 - it reads the environment during its import

    module: ModuleType = cv2
    return module


class OpenCvCamera(SensorSource):
    """A USB camera; all calls come from one thread, as Windows requires, and may block it while a driver hangs."""

    name = "opencv"

    def __init__(self, device: str, opencv: ModuleType) -> None:
        """`device`: a path or a number."""
        self._device, self._opencv = device, opencv
        self._hz, self._delivered = HZ, False
        self._capture: Any = None

    def trouble(self) -> str:
        """Return why the path cannot be opened, else an empty text; OpenCV must open a number to check it."""
        if not self._device.startswith("/"):
            return ""
        if not Path(self._device).exists():
            return f"{self._device} is not there: plug the camera in. The node finds it."
        if not os.access(self._device, os.R_OK | os.W_OK):
            return (
                f"{self._device} cannot be opened by this user: type `sudo usermod -aG video $USER`, then log out "
                "and in again."
            )
        return ""

    def open(self) -> None:
        """Open the camera with 640 x 480 pixels; on Linux take its motion JPEG without decoding, if it has that."""
        cv = self._opencv
        device = int(self._device) if self._device.isdigit() else self._device
        self._capture = cv.VideoCapture(device, getattr(cv, BACKENDS.get(sys.platform, "CAP_V4L2")))
        if not self._capture.isOpened():
            raise NoAnswer(Reason.FAULT, self._missing())
        self._capture.set(cv.CAP_PROP_FOURCC, MOTION_JPEG)  # a driver may ignore this
        self._capture.set(cv.CAP_PROP_FRAME_WIDTH, WIDTH)
        self._capture.set(cv.CAP_PROP_FRAME_HEIGHT, HEIGHT)
        self._capture.set(cv.CAP_PROP_FPS, self._hz)
        if sys.platform not in BACKENDS and self._capture.get(cv.CAP_PROP_FOURCC) == MOTION_JPEG:
            self._capture.set(cv.CAP_PROP_CONVERT_RGB, 0)

    def next(self, timeout_s: float) -> SensorFrame | None:
        """Return the next picture; None if it is damaged or does not arrive in time."""
        began_s = time.monotonic()
        pixels: Pixels | None = self._capture.read()[1]
        if pixels is None:
            failed = time.monotonic() - began_s < PAUSE_S and not (
                self._delivered or sys.platform in BACKENDS
            )
            if failed or self.trouble():
                raise NoAnswer(Reason.FAULT, self.trouble() or self._missing())
            time.sleep(min(timeout_s, PAUSE_S))  # on Windows and macOS a camera may need seconds to begin
            return None
        try:
            return self._frame(pixels, time.monotonic_ns())
        except ValueError as error:  # cameras send damaged pictures after their start and on bad cables
            log.debug("%s: damaged picture skipped (%s).", self._device, error)
            return None

    def _frame(self, pixels: Pixels, now_ns: int) -> SensorFrame:
        """Return a picture with the time of its exposure, or of its arrival; raises ValueError if it is damaged."""
        if pixels.ndim == 3:
            height, width = pixels.shape[:2]
            encoded = simplejpeg.encode_jpeg(pixels, QUALITY, colorspace="BGR", colorsubsampling="420")
        else:
            encoded = jpeg.complete(pixels.tobytes())
            height, width, *_ = simplejpeg.decode_jpeg_header(encoded)
        self._delivered = True
        exposed_ns = round(self._capture.get(self._opencv.CAP_PROP_POS_MSEC) * 1e6)
        t_mono_ns = exposed_ns if now_ns - AGE_NS < exposed_ns < now_ns else now_ns
        return picture(encoded, width, height, t_mono_ns, self.name)

    def close(self) -> None:
        """Release the camera; if it was open and has delivered no picture, the next attempt is at the other rate."""
        if self._capture is None:
            return
        if self._capture.isOpened() and not self._delivered:
            self._hz = HZ if self._hz == LOW_HZ else LOW_HZ
        self._capture.release()
        self._capture, self._delivered = None, False

    def _missing(self) -> str:
        """Return the message, with all possible reasons, for a camera that fails: OpenCV does not report the reason."""
        permission = PERMISSION.get(sys.platform, "this user may not use it")
        return f"Camera {self._device} cannot be read: it is not plugged in, another program uses it, its USB bus has no bandwidth for it, or {permission}. The node retries every second."
