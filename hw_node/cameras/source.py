"""The format of cameras, and the timer of sources that are not cameras."""

from __future__ import annotations

import time

from beatrix_zenoh.node import CameraFrame
from beatrix_zenoh.node.sensors import SensorSource

WIDTH, HEIGHT, HZ = 640, 480, 30
"""Format requested from cameras: pixels, and pictures a second."""


FrameSource = SensorSource[CameraFrame]
"""A camera or another source of pictures."""


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
