"""A camera that OpenCV reads as an eye of a robot: open while a client subscribes, lost and found."""

from __future__ import annotations

import pytest
from fake_opencv import FakeOpenCv
from robots import Stage, until

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.node import Component, Node
from hw_node import sensor
from hw_node.body import VirtualHardware
from hw_node.cameras.camera import CameraSensor
from hw_node.cameras.opencv import OpenCvCamera


class HardwareWithOneEye(VirtualHardware):
    """A virtual board with one eye."""

    def __init__(self, name: str, module: FakeOpenCv) -> None:
        super().__init__(name, cameras=())
        self._module = module

    def components(self, node: Node) -> list[Component]:
        return [CameraSensor(node, "left", OpenCvCamera(0, self._module))]


def test_an_eye_is_open_while_subscribed_and_returns_after_unplugging(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sensor, "CHECK_S", 0.05)
    module = FakeOpenCv()
    with Stage() as stage:
        node = Node(
            Sessions(lambda: zbus.connect(stage.endpoint)), "bea", HardwareWithOneEye("bea", module)
        ).start()
        robot = stage.robot("bea", "hw")
        assert module.opened == []
        with robot.camera("left") as images, robot.events(timeout_s=20.0) as events:
            assert images.next(5.0).source == "opencv"
            module.plugged = False
            found = (event for event in events if event.kind is EventKind.CAMERA)
            assert "it is not plugged in" in next(found).message
            until(lambda: not robot.status().cameras[0].connected, "its absence is in the status")
            module.plugged = True
            until(lambda: "is connected again" in next(found).message, "it is found by itself")
            images.take()
            assert images.next(5.0).width == 640
        until(lambda: module.released == len(module.opened), "it is closed when no client watches")
        robot.client.close()
        node.close()
