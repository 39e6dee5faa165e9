"""USB cameras through OpenCV, whose calls may block, and do not report why they fail."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
import simplejpeg
from fake_opencv import PLUM, FakeOpenCv
from robots import until

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.node import CameraFrame
from hw_node.cameras import opencv
from hw_node.cameras.opencv import OpenCvCamera


@pytest.fixture
def module() -> FakeOpenCv:
    return FakeOpenCv()


@pytest.fixture
def camera(module: FakeOpenCv) -> Iterator[OpenCvCamera]:
    camera = OpenCvCamera(1, module)
    yield camera
    module.goes_on.set()
    camera.close()
    until(lambda: not opencv_threads(), "its thread has ended")


def opencv_threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("beatrix-opencv")]


def picture(camera: OpenCvCamera) -> CameraFrame:
    frame = camera.next(5.0)
    assert frame is not None
    return frame


def test_pictures_are_jpeg_with_correct_colours_size_and_time(
    camera: OpenCvCamera, module: FakeOpenCv
) -> None:
    begin_ns = time.monotonic_ns()
    camera.open()
    frame = picture(camera)
    assert (frame.width, frame.height, frame.source) == (640, 480, "opencv")
    assert begin_ns < frame.t_mono_ns < time.monotonic_ns()
    pixels = simplejpeg.decode_jpeg(frame.jpeg)
    assert np.abs(pixels.astype(int) - PLUM[::-1]).max() < 6


@pytest.mark.parametrize(("platform", "backend"), [("win32", 700), ("darwin", 1200)])
def test_motion_jpeg_is_requested_with_the_backend_of_each_system(
    camera: OpenCvCamera, module: FakeOpenCv, monkeypatch: pytest.MonkeyPatch, platform: str, backend: int
) -> None:
    monkeypatch.setattr(sys, "platform", platform)
    camera.open()
    picture(camera)
    assert module.opened == [(1, backend)]
    assert module.captures[0].asked == {3: 640, 4: 480, 5: 30, 6: 0x47504A4D}


def test_an_unplugged_camera_is_an_error_and_can_be_reopened(
    camera: OpenCvCamera, module: FakeOpenCv
) -> None:
    camera.open()
    picture(camera)
    module.plugged = False
    with pytest.raises(NoAnswer, match="Camera 1 cannot be read: it is not plugged in"):
        all(camera.next(1.0) for _ in range(10))
    camera.close()
    module.plugged = True
    camera.open()
    picture(camera)
    assert (len(module.opened), module.released) == (2, 1)


def test_a_blocked_read_blocks_no_other_thread_and_the_camera_is_not_opened_twice(
    camera: OpenCvCamera, module: FakeOpenCv, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(opencv, "END_S", 0.05)
    module.goes_on.clear()
    camera.open()
    assert camera.next(0.05) is None
    camera.close()
    with pytest.raises(NoAnswer, match="unplug it, and plug it in again"):
        camera.open()
    assert len(module.opened) == 1
    module.goes_on.set()
    until(lambda: module.released == 1, "the blocked thread frees the camera itself")
    until(lambda: not opencv_threads(), "the blocked thread ends")
    camera.open()
    picture(camera)
