"""Cameras of a simulation; tests/nodes/test_usb_cameras.py has those of the hardware."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import simplejpeg
from bodies import Body
from robots import wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh.contract.names import EYES

pytestmark = pytest.mark.bodies("sim")
LONG_S = 60.0
"""Time limit (s) of a first picture, which may need an OpenGL context on a busy machine."""


@pytest.fixture
def watcher(body: Body) -> Iterator[Robot]:
    """A client of a robot with two cameras, none of which streams."""
    robot = body.robot()
    assert tuple(one.eye for one in robot.status().cameras) == EYES
    wait_status(
        robot,
        lambda status: not any(one.streaming for one in status.cameras),
        "no subscriber is left",
        LONG_S,
    )
    yield robot
    robot.client.close()


def test_each_eye_shows_a_picture_of_its_own_with_time_and_number(watcher: Robot) -> None:
    pictures = {}
    for eye in (*EYES, "outside"):
        with watcher.camera(eye, timeout_s=LONG_S) as images:
            image, second = images.next(), images.next()
        assert second.seq > image.seq
        assert second.t_mono_ns > image.t_mono_ns
        for one in (image, second):
            assert 0 < one.arrived_mono_ns - one.t_mono_ns < LONG_S * 1e9
            assert 0 < one.arrived_wall_ns - one.t_wall_ns < LONG_S * 1e9
        pixels = simplejpeg.decode_jpeg(image.jpeg)
        assert pixels.shape == (image.height, image.width, 3)
        assert image.eye == eye
        pictures[eye] = pixels
    assert (pictures["left"] != pictures["right"]).any()
