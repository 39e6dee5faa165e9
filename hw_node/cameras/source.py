"""The protocol of cameras, and the timer of sources that are not cameras."""

from __future__ import annotations

import time
from typing import Protocol

from beatrix_zenoh.node import CameraFrame

WIDTH, HEIGHT, HZ = 640, 480, 30
"""Format requested from cameras: pixels, and pictures a second."""


class FrameSource(Protocol):
    """A camera or another source of pictures; used by one thread.

    `open` and `next` raise NoAnswer, with a message that says what to do, if there are no pictures.
    """

    @property
    def name(self) -> str:
        """Kind of source, as in `CameraFrame.source`."""

    def trouble(self) -> str:
        """Return why there can be no picture now, empty if no reason is known; quick, and does not open the source."""

    def open(self) -> None:
        """Start taking pictures."""

    def next(self, timeout_s: float) -> CameraFrame | None:
        """Wait for the next picture and return it; None if none arrives within `timeout_s`."""

    def close(self) -> None:
        """Stop taking pictures; may be called twice, and after `open` has failed."""


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
