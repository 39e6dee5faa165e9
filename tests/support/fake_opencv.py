"""A fake OpenCV with one USB camera that can be unplugged, or deliver no picture."""

from __future__ import annotations

from types import ModuleType

import numpy as np

from hw_node.cameras.opencv import Pixels

PLUM = (40, 20, 120)
"""Blue, green and red of the camera's pictures."""


class FakeOpenCv(ModuleType):
    """A replacement for the module `cv2`."""

    CAP_V4L2, CAP_DSHOW, CAP_AVFOUNDATION = 200, 700, 1200
    CAP_PROP_POS_MSEC, CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FPS = 0, 3, 4, 5
    CAP_PROP_FOURCC, CAP_PROP_CONVERT_RGB = 6, 16

    def __init__(self) -> None:
        super().__init__("cv2")
        self.plugged = self.works = True
        self.opened: list[tuple[int | str, int]] = []
        self.asked: dict[int, float] = {}
        self.released = 0

    def VideoCapture(self, device: int | str, backend: int, /) -> FakeCapture:  # noqa: N802
        self.opened.append((device, backend))
        return FakeCapture(self)


class FakeCapture:
    """A replacement for `cv2.VideoCapture`, of a driver that ignores all properties."""

    def __init__(self, module: FakeOpenCv) -> None:
        self._module = module

    def isOpened(self) -> bool:  # noqa: N802
        return self._module.plugged

    def set(self, property_id: int, value: float, /) -> bool:
        self._module.asked[property_id] = value
        return False

    def get(self, _property_id: int, /) -> float:
        return -1.0

    def read(self) -> tuple[bool, Pixels | None]:
        picture = np.full((480, 640, 3), PLUM, np.uint8)
        return (True, picture) if self._module.works else (False, None)

    def release(self) -> None:
        self._module.released += 1
