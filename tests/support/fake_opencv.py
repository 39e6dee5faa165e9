"""A fake OpenCV with one USB camera that can be unplugged, slow, in use or blocked."""

from __future__ import annotations

import threading
from types import ModuleType

import numpy as np

from hw_node.cameras.opencv import Pixels

PLUM = (40, 20, 120)
"""Blue, green and red of the camera's pictures."""


def plain(width: int = 640, height: int = 480) -> Pixels:
    """Return a picture of one colour."""
    return np.full((height, width, 3), PLUM, np.uint8)


class FakeOpenCv(ModuleType):
    """A replacement for the module `cv2`."""

    CAP_ANY, CAP_DSHOW, CAP_AVFOUNDATION = 0, 700, 1200
    CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FPS, CAP_PROP_FOURCC = 3, 4, 5, 6

    def __init__(self) -> None:
        super().__init__("cv2")
        self.plugged = True
        self.goes_on = threading.Event()
        """While this event is clear, reads block."""
        self.goes_on.set()
        self.opened: list[tuple[int, int]] = []
        self.captures: list[FakeCapture] = []

    def VideoCapture(self, index: int, backend: int, /) -> FakeCapture:  # noqa: N802
        self.opened.append((index, backend))
        self.captures.append(FakeCapture(self))
        return self.captures[-1]

    @property
    def released(self) -> int:
        return sum(capture.released for capture in self.captures)


class FakeCapture:
    """A replacement for `cv2.VideoCapture`; a picture arrives every 5 ms."""

    def __init__(self, module: FakeOpenCv) -> None:
        self._module, self._connected = module, module.plugged
        self.asked: dict[int, float] = {}
        self.released = False
        self.thread = threading.current_thread()

    def isOpened(self) -> bool:  # noqa: N802
        return self._connected

    def set(self, property_id: int, value: float, /) -> bool:
        self.asked[property_id] = value
        return False  # as a driver without this property does

    def read(self) -> tuple[bool, Pixels | None]:
        assert threading.current_thread() is self.thread, "on Windows one thread must make all calls"
        self._module.goes_on.wait(10.0)
        threading.Event().wait(0.005)
        self._connected &= self._module.plugged  # it must be opened again after unplugging
        return self._connected, plain() if self._connected else None

    def release(self) -> None:
        assert threading.current_thread() is self.thread, "on Windows one thread must make all calls"
        self.released = True
