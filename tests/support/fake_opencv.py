"""A fake OpenCV with one USB camera that can be unplugged, slow, in use or blocked."""

from __future__ import annotations

import threading
from collections import deque

import numpy as np

from hw_node.cameras.opencv import Pixels

PLUM = (40, 20, 120)
"""Blue, green and red of the camera's pictures."""


def plain(width: int = 640, height: int = 480) -> Pixels:
    """Return a picture of one colour."""
    return np.full((height, width, 3), PLUM, np.uint8)


class FakeOpenCv:
    """A replacement for the module `cv2`."""

    CAP_ANY, CAP_DSHOW, CAP_AVFOUNDATION = 0, 700, 1200
    CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FPS, CAP_PROP_FOURCC = 3, 4, 5, 6

    def __init__(self) -> None:
        self.plugged = True
        self.pictures: deque[Pixels] = deque()
        self.failures = 0
        """How often a read fails before the first picture."""
        self.endless = True
        """If true, a picture arrives every 5 ms without end; otherwise those of `pictures` arrive."""
        self.goes_on = threading.Event()
        """While this event is clear, reads block."""
        self.goes_on.set()
        self.opens_at_once = threading.Event()
        self.opens_at_once.set()
        self.opened: list[tuple[int, int]] = []
        self.captures: list[FakeCapture] = []

    def VideoCapture(self, index: int, backend: int, /) -> FakeCapture:  # noqa: N802
        self.opened.append((index, backend))
        self.opens_at_once.wait(10.0)
        capture = FakeCapture(self)
        self.captures.append(capture)
        return capture

    @property
    def released(self) -> int:
        return sum(capture.released for capture in self.captures)


class FakeCapture:
    """A replacement for `cv2.VideoCapture`."""

    def __init__(self, module: FakeOpenCv) -> None:
        self._module, self._connected = module, module.plugged
        self._pause = threading.Event()
        self.asked: dict[int, float] = {}
        self.released = False
        self.thread = threading.current_thread()

    def isOpened(self) -> bool:  # noqa: N802
        return self._connected

    def set(self, property_id: int, value: float, /) -> bool:
        self.asked[property_id] = value
        return False  # as a driver without this property does

    def grab(self) -> bool:
        assert threading.current_thread() is self.thread, "on Windows one thread must make all calls"
        self._module.goes_on.wait(10.0)
        if self._module.failures:
            self._module.failures -= 1
            return False
        self._pause.wait(0.005)
        self._connected = (
            self._connected and self._module.plugged
        )  # a camera must be opened again after unplugging
        return self._connected and bool(self._module.endless or self._module.pictures)

    def retrieve(self) -> tuple[bool, Pixels | None]:
        return True, plain() if self._module.endless else self._module.pictures.popleft()

    def release(self) -> None:
        assert threading.current_thread() is self.thread, "on Windows one thread must make all calls"
        self.released = True
