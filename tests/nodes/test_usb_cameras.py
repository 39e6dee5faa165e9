"""USB cameras of a hardware node: real library, structures and calls; the test replies instead of the kernel."""

from __future__ import annotations

import errno
import sys
from collections.abc import Iterator

import numpy as np
import pytest
import simplejpeg
from fake_camera import FakeCamera, library
from robots import Stage, ready, until, wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh.client import Subscription
from beatrix_zenoh.client.subscription import CameraImage
from beatrix_zenoh.contract._generated.messages import Event, EventKind, Reason

pytest.importorskip("cv2")
pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux has V4L2")

PICTURE: bytes = simplejpeg.encode_jpeg(
    np.random.default_rng(1).integers(0, 8, (480, 640, 3), np.uint8), quality=40
)


@pytest.fixture(scope="module")
def cameras(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, FakeCamera]]:
    folder = tmp_path_factory.mktemp("v4l")
    found = {eye: FakeCamera(folder / f"usb-{eye}") for eye in ("left", "right")}
    yield found
    for camera in found.values():
        camera.close()


@pytest.fixture(scope="module")
def stage(cameras: dict[str, FakeCamera], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """A node with two USB cameras."""
    with pytest.MonkeyPatch.context() as patch, Stage() as stage:
        patch.setenv("LD_PRELOAD", str(library(tmp_path_factory.mktemp("built"))))
        words = [word for eye, camera in cameras.items() for word in ("--camera", f"{eye}={camera.path}")]
        stage.hardware("bea", "virtual:", *words)
        yield stage


@pytest.fixture
def robot(stage: Stage) -> Iterator[Robot]:
    robot = stage.robot("bea", "hw")
    yield robot
    robot.client.close()


@pytest.fixture
def left(cameras: dict[str, FakeCamera]) -> FakeCamera:
    until(lambda: not any(camera.asked for camera in cameras.values()), "no camera is in use")
    return cameras["left"]


def streams(camera: FakeCamera, images: Subscription[CameraImage], picture: bytes = PICTURE) -> CameraImage:
    """Send pictures until one arrives, and return it; pictures before the start of the stream are lost."""
    found: list[CameraImage] = []

    def arrived() -> bool:
        camera.send(picture)
        found.extend(images.take(0.1))
        return bool(found)

    until(arrived, "a picture")
    images.take(0.1)
    return found[-1]


def test_pictures_are_published_unchanged_with_the_time_of_their_exposure(
    left: FakeCamera, robot: Robot
) -> None:
    with robot.camera("left") as images:
        first = streams(left, images)
        assert left.asked == "640x480 MJPG 1/30 4"
        left.send(PICTURE[:1000], damaged=True)
        left.send(b"no picture at all")
        left.send(PICTURE)
        image = images.next(5.0)
    until(lambda: left.asked == "", "the camera is closed without a subscriber")
    assert image.jpeg == PICTURE
    assert (image.width, image.height, image.source) == (640, 480, "opencv")
    assert image.seq > first.seq
    assert 0 < image.arrived_mono_ns - image.t_mono_ns < 2e9


def test_an_unplugged_camera_does_not_stop_the_robot_and_returns(left: FakeCamera, robot: Robot) -> None:
    ready(robot)
    with robot.camera("left") as images, robot.events(timeout_s=20.0) as events:
        streams(left, images)
        motion = robot.look(yaw=20, wait=False)
        left.unplug()
        lost = camera_event(events)
        assert (lost.action, lost.reason) == ("left", Reason.FAULT)
        assert "plug the camera in" in lost.message
        status = robot.status()
        assert not status.cameras[0].connected
        assert any("left eye" in warning for warning in status.warnings)
        assert motion.result(10.0) is not None, "the motion continues"
        left.plug()
        assert streams(left, images).jpeg == PICTURE
        found = camera_event(events)
        assert (found.action, found.reason) == ("left", Reason.OK)
    camera = robot.status().cameras[0]
    assert (camera.connected, camera.trouble) == (True, "")


def test_a_camera_in_use_by_another_program_is_tried_again(left: FakeCamera, robot: Robot) -> None:
    left.refuse(errno.EBUSY)
    with robot.camera("left") as images:
        wait_status(robot, lambda status: "another program" in status.cameras[0].trouble, "busy is reported")
        left.refuse(0)
        streams(left, images)
    assert robot.status().cameras[0].trouble == ""


def test_without_usb_bandwidth_a_camera_streams_at_half_the_rate(left: FakeCamera, robot: Robot) -> None:
    left.refuse(errno.ENOSPC, from_hz=30)
    with robot.camera("left") as images:
        streams(left, images)
        assert left.asked == "640x480 MJPG 1/15 4"
    left.refuse(0)


def camera_event(events: Subscription[Event]) -> Event:
    return next(event for event in events if event.kind is EventKind.CAMERA)
