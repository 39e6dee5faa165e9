"""USB cameras through a fake OpenCV, whose driver decodes the pictures and reports neither errors nor times."""

from __future__ import annotations

import sys
import time
from types import ModuleType

import numpy as np
import pytest
import simplejpeg

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.contract._generated.messages import FrameHeader
from hw_node.cameras.opencv import OpenCvCamera, Pixels

PLUM = (40, 20, 120)
"""Blue, green and red of the camera's pictures."""


class FakeOpenCv(ModuleType):
    """A replacement for the module `cv2` with one USB camera, and for its capture, whose driver ignores all properties."""

    CAP_V4L2, CAP_DSHOW, CAP_AVFOUNDATION = 200, 700, 1200
    CAP_PROP_POS_MSEC, CAP_PROP_FRAME_WIDTH, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FPS = 0, 3, 4, 5
    CAP_PROP_FOURCC, CAP_PROP_CONVERT_RGB = 6, 16

    def __init__(self) -> None:
        super().__init__("cv2")
        self.plugged = self.works = True
        self.opened: list[tuple[int | str, int]] = []
        self.asked: dict[int, float] = {}
        self.released = 0

    def VideoCapture(self, device: int | str, backend: int, /) -> FakeOpenCv:  # noqa: N802
        self.opened.append((device, backend))
        return self

    def isOpened(self) -> bool:  # noqa: N802
        return self.plugged

    def set(self, property_id: int, value: float, /) -> bool:
        self.asked[property_id] = value
        return False

    def get(self, _property_id: int, /) -> float:
        return -1.0

    def read(self) -> tuple[bool, Pixels | None]:
        return (True, np.full((480, 640, 3), PLUM, np.uint8)) if self.works else (False, None)

    def release(self) -> None:
        self.released += 1


@pytest.fixture(autouse=True)
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")


@pytest.mark.parametrize(
    ("platform", "device", "opened"),
    [
        ("win32", "1", (1, 700)),
        ("darwin", "1", (1, 1200)),
        ("linux", "/dev/v4l/by-path/a", ("/dev/v4l/by-path/a", 200)),
    ],
)
def test_pictures_that_the_driver_decodes_become_jpeg_with_the_time_of_their_arrival(
    monkeypatch: pytest.MonkeyPatch, platform: str, device: str, opened: tuple[int | str, int]
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    module = FakeOpenCv()
    camera = OpenCvCamera(device, module)
    begin_ns = time.monotonic_ns()
    camera.open()
    frame = camera.next(5.0)
    assert frame is not None
    assert module.opened == [opened]
    assert module.asked == {3: 640, 4: 480, 5: 30, 6: 0x47504A4D}
    assert isinstance(frame.header, FrameHeader)
    assert (frame.header.width, frame.header.height, frame.header.source) == (640, 480, "opencv")
    assert begin_ns < frame.header.t_mono_ns < time.monotonic_ns()
    assert np.abs(simplejpeg.decode_jpeg(frame.payload).astype(int) - PLUM[::-1]).max() < 6


def test_an_unplugged_camera_is_an_error_and_one_that_delivers_nothing_is_reopened_at_half_the_rate() -> None:
    module = FakeOpenCv()
    camera = OpenCvCamera("1", module)
    rates = []
    for plugged, works in ((True, True), (False, False), (True, False), (True, True)):
        module.plugged, module.works = plugged, works
        if plugged:
            camera.open()
            assert (camera.next(0.01) is not None) == works
            rates.append(module.asked[module.CAP_PROP_FPS])
        else:
            with pytest.raises(NoAnswer, match="Camera 1 cannot be read: it is not plugged in"):
                camera.open()
        camera.close()
    assert (rates, module.released) == ([30, 30, 15], 4)
