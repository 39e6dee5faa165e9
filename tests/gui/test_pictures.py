"""Pictures from a real simulation and a virtual board: subscribed while wanted, and again when a robot returns."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
from robots import Process, Stage, until, wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh.client import CameraImage, Client
from gui.console.link.pictures import Camera, CameraStream, Streams

FIRST_S = 20.0
"""Longest wait (s) for the first picture, which starts rendering."""
LEFT = ("hw", "left")


class ImageLog:
    """Stores the delivered pictures, and the names of the threads that deliver them."""

    def __init__(self) -> None:
        self.seen: dict[tuple[str, str], list[CameraImage]] = {}
        self.threads: set[str] = set()

    def add(self, side: str, image: CameraImage) -> None:
        self.threads.add(threading.current_thread().name)
        self.seen.setdefault((side, image.eye), []).append(image)

    def count(self, *place: str) -> int:
        return len(self.seen.get((place[0], place[1]), []))


@pytest.fixture(scope="module")
def stage(bea: Stage) -> Iterator[Stage]:
    yield bea
    bea.close_clients()


@pytest.fixture
def client(stage: Stage) -> Iterator[Client]:
    client = stage.client("window")
    yield client
    client.close()


@pytest.fixture
def hw(stage: Stage) -> Iterator[Robot]:
    robot = stage.robot("bea", "hw")
    wait_status(robot, lambda status: not any(eye.streaming for eye in status.cameras), "no client watches")
    yield robot
    robot.client.close()


@pytest.fixture
def images_taken() -> ImageLog:
    return ImageLog()


def streams(client: Client, robot: str, images_taken: ImageLog) -> Streams[Camera, CameraStream]:
    """Return the cameras of the robots of a name, without subscriptions."""
    return Streams(lambda camera: CameraStream(client, (robot, *camera), images_taken.add))


@pytest.fixture
def pictures(client: Client, images_taken: ImageLog) -> Iterator[Streams[Camera, CameraStream]]:
    made = streams(client, "bea", images_taken)
    yield made
    made.close()


def test_a_camera_streams_only_while_its_pictures_are_wanted(
    pictures: Streams[Camera, CameraStream], images_taken: ImageLog, hw: Robot
) -> None:
    pictures.watch(frozenset({LEFT}))
    until(lambda: images_taken.count(*LEFT) > 3, "pictures come", FIRST_S)
    left, right = hw.status().cameras
    assert left.streaming
    assert not right.streaming
    pictures.watch(frozenset())
    last = images_taken.count(*LEFT)
    wait_status(hw, lambda status: not status.cameras[0].streaming, "the camera stops")
    assert images_taken.count(*LEFT) == last, "unsubscribed pictures are not delivered"


def test_pictures_return_with_a_restarted_robot(stage: Stage, client: Client, images_taken: ImageLog) -> None:
    pictures = streams(client, "mortal", images_taken)
    pictures.watch(frozenset({LEFT}))

    def born() -> Process:
        process = stage.hardware("mortal")
        seen = images_taken.count(*LEFT)
        until(lambda: images_taken.count(*LEFT) > seen + 2, "pictures come", FIRST_S)
        return process

    born().end()
    born().end()
    pictures.close()
