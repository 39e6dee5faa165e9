"""Camera faults inside a node: the robot continues and reports them."""

from __future__ import annotations

import queue
import time
from collections.abc import Iterator
from itertools import islice

import pytest
from robots import Stage, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.node import SensorFrame, picture, sensors
from hw_node.body import VirtualHardware
from hw_node.cameras.camera import camera_sensor

PICTURE = b"\xff\xd8" + bytes(40_000)


class FakeSource(sensors.SensorSource):
    """A camera source that the test controls."""

    name = "test"

    def __init__(self) -> None:
        self.missing = ""
        self.opened = self.closed = 0
        self.feed: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()

    def trouble(self) -> str:
        return self.missing

    def open(self) -> None:
        self.opened += 1

    def next(self, timeout_s: float) -> SensorFrame | None:
        try:
            error = self.feed.get(timeout=timeout_s)
        except queue.Empty:
            return None
        if error is not None:
            raise error
        return picture(PICTURE, 4, 3, time.monotonic_ns(), self.name)

    def close(self) -> None:
        self.closed += 1


class HardwareWithOneEye(VirtualHardware):
    """A virtual board with one eye, whose pictures come from `source`."""

    def __init__(self, name: str, source: FakeSource) -> None:
        super().__init__(name, sensors=[lambda node: camera_sensor(node, "left", source)])


@pytest.fixture
def source(monkeypatch: pytest.MonkeyPatch) -> FakeSource:
    monkeypatch.setattr(sensors, "CHECK_S", 0.05)
    return FakeSource()


@pytest.fixture
def stage(source: FakeSource) -> Iterator[Stage]:
    with Stage() as stage:
        stage.node("bea", HardwareWithOneEye("bea", source))
        yield stage


@pytest.fixture
def robot(stage: Stage) -> Robot:
    return stage.robot("bea", "hw")


def trouble(robot: Robot) -> str:
    return robot.status().cameras[0].trouble


def test_a_camera_is_open_only_while_a_client_subscribes(source: FakeSource, robot: Robot) -> None:
    with robot.camera("left") as images:
        source.feed.put(None)
        assert images.next(5.0).jpeg == PICTURE
        assert (source.opened, source.closed) == (1, 0)
    until(lambda: source.closed == 1, "the camera is closed with its last subscriber")
    with robot.camera("left"):
        until(lambda: source.opened == 2, "it opens again")


def test_a_camera_fault_is_shown_until_the_next_picture(source: FakeSource, robot: Robot) -> None:
    """The fault must not disappear with each attempt to open the camera, and a mistake does not end the node."""
    with robot.camera("left") as images, robot.events(timeout_s=20.0) as events:
        for _ in range(3):
            source.feed.put(NoAnswer(Reason.FAULT, "It is used by another program."))
        until(lambda: source.opened >= 3, "it is tried again")
        assert trouble(robot) == "It is used by another program."
        source.feed.put(None)
        images.next(5.0)
        until(lambda: trouble(robot) == "", "the trouble is over")
        source.feed.put(KeyError("a mistake"))
        until(lambda: "The device failed: 'a mistake'" in trouble(robot), "the mistake is shown")
        messages = [event.message for event in islice((one for one in events if one.kind == "camera"), 2)]
    assert messages == [
        "left eye: It is used by another program.",
        "left eye: connected again.",
    ]


def test_a_camera_that_is_plugged_in_later_is_used(source: FakeSource, robot: Robot) -> None:
    source.missing = "It is not there."
    until(lambda: trouble(robot) == "It is not there.", "its absence is shown")
    before = source.opened
    with robot.camera("left") as images:
        assert source.opened == before
        source.missing = ""
        source.feed.put(None)
        images.next(5.0)
