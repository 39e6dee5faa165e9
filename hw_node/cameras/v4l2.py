"""USB cameras on Linux: motion JPEG as the camera delivers it. Only this module imports linuxpy."""

from __future__ import annotations

import errno
import logging
import select
import time
from pathlib import Path
from typing import Final

from linuxpy.video import device as v4l2

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras import jpeg
from hw_node.cameras.jpeg import HEIGHT, HZ, WIDTH

RATES_HZ: Final = (HZ, 15)
"""The second rate is for USB buses that have no bandwidth for two cameras at the first rate."""
BUFFERS: Final = 4
"""Pictures that the kernel queues."""
GONE: Final = (errno.ENODEV, errno.ENXIO, errno.EIO, errno.ENOENT, errno.EBADF, errno.EPROTO)
NO_CAMERA: Final = " is not a camera: `ls /dev/v4l/by-path` lists the cameras"
WHY: Final[dict[int | None, str]] = {
    errno.EACCES: " cannot be opened by this user: type `sudo usermod -aG video $USER`, then log out and in again",
    errno.EBUSY: " is used by another program: end that program first",
    errno.ENOSPC: ": its USB bus has no bandwidth for another camera. Plug one into a port on the other side of the computer",
    errno.ENOTTY: NO_CAMERA,
    errno.EINVAL: NO_CAMERA,
}
"""The rest of the sentence about a path, by the errno value."""
FORMATS: Final = (v4l2.PixelFormat.MJPEG, v4l2.PixelFormat.JPEG)

log = logging.getLogger(__name__)


class V4l2Camera:
    """A USB camera by its path, preferably a permanent one: /dev/v4l/by-path/… or by-id/…."""

    name: Final = "v4l2"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._device: v4l2.Device | None = None
        self._capture: v4l2.VideoCapture | None = None

    def trouble(self) -> str:
        """Return an error message if the path does not exist, else an empty text."""
        return "" if self._path.exists() else self._why_not(errno.ENODEV)

    def open(self) -> None:
        """Start with 640 x 480 pixels in motion JPEG; at half the rate if the USB bus has no bandwidth for more."""
        for hz in RATES_HZ:
            try:
                self._start(hz)
            except (OSError, ValueError, v4l2.V4L2Error) as error:
                self.close()
                number = getattr(error, "errno", None)
                if number == errno.ENOSPC and hz != RATES_HZ[-1]:
                    continue
                raise NoAnswer(Reason.FAULT, self._why_not(number, str(error))) from error
            if hz != HZ:
                text = "%s runs at %d pictures a second: its USB bus has no bandwidth for %d."
                log.warning(text, self._path, hz, HZ)
            return

    def _start(self, hz: int) -> None:
        self._device = v4l2.Device(self._path)
        self._device.open()
        self._capture = v4l2.VideoCapture(self._device, size=BUFFERS)
        self._capture.set_format(WIDTH, HEIGHT, "MJPG")
        if self._capture.get_format().pixel_format not in FORMATS:
            raise NoAnswer(
                Reason.FAULT,
                f"{self._path} delivers no motion JPEG (MJPG), the only supported format. Use another camera.",
            )
        self._capture.set_fps(hz)
        self._capture.open()

    def next(self, timeout_s: float) -> CameraFrame | None:
        """Return the next picture with the time of its exposure; None if it is damaged or does not arrive in time."""
        if self._device is None or self._capture is None:
            return None
        try:
            ready, _, _ = select.select([self._device], [], [], timeout_s)
            if not ready:
                return None
            one = self._capture.buffer.raw_read()
        except OSError as error:
            if error.errno == errno.EAGAIN:
                return None
            raise NoAnswer(Reason.FAULT, self._why_not(error.errno, str(error))) from error
        try:
            return to_frame(one)
        except ValueError as error:  # cameras send damaged pictures after their start and on bad cables
            log.debug("%s: damaged picture skipped (%s).", self._path, error)
            return None

    def close(self) -> None:
        """Stop and release the camera; errors of a camera that was unplugged are ignored."""
        capture, device = self._capture, self._device
        self._capture = self._device = None
        for part in (capture, device):
            try:
                if part is not None:
                    part.close()
            except (OSError, v4l2.V4L2Error) as error:
                log.debug("%s: %s", self._path, error)

    def _why_not(self, number: int | None, said: str = "") -> str:
        """Return the reason why there are no pictures, and what to do."""
        if number in GONE:
            return f"{self._path} is not there: plug the camera in. The node finds it."
        return f"{self._path}{WHY.get(number, f' cannot be read ({said})')}."


def to_frame(one: v4l2.Frame) -> CameraFrame:
    """Return the picture as a JPEG file; raises ValueError if it is damaged."""
    if v4l2.BufferFlag.ERROR in one.flags:
        raise ValueError("the camera has marked it as damaged")
    picture = jpeg.complete(bytes(one.data))
    width, height = jpeg.size(picture)
    return CameraFrame(picture, width, height, exposed_ns(one), V4l2Camera.name)


def exposed_ns(one: v4l2.Frame) -> int:
    """Return the monotonic time of the exposure of a picture; now if the driver uses another clock."""
    if v4l2.BufferFlag.TIMESTAMP_MONOTONIC not in one.flags:
        return time.monotonic_ns()
    stamp = one.buff.timestamp
    return int(stamp.secs) * 1_000_000_000 + int(stamp.usecs) * 1000
