"""A board that takes a motion and does not make it: whoever asked is told, and the robot is not blocked."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from stage import Stage, ready

from beatrix_zenoh import Interrupted
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import FrameType
from beatrix_zenoh.board.board import Port
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.node import Node, Roads
from hw_node.body import VirtualHardware


class LazyPort:
    """A port whose board acknowledges MOVE and forgets it, while it is lazy."""

    name = "lazy:"
    boot_s = 0.0

    def __init__(self, port: Port) -> None:
        self._port = port
        self._decoder = Decoder()
        self._said = b""
        self.lazy = True

    def write(self, data: bytes) -> None:
        for frame in self._decoder.feed(data):
            if self.lazy and frame.type in (FrameType.MOVE, FrameType.MOVE_STRAIGHT):
                self._said += encode(frame.type | FrameType.ACK, frame.seq, b"\0")
            else:
                self._port.write(encode(frame.type, frame.seq, frame.payload))

    def read(self, timeout_s: float) -> bytes:
        said, self._said = self._said, b""
        return said + self._port.read(timeout_s)

    def close(self) -> None:
        """The board behind stays."""


class LazyHardware(VirtualHardware):
    def open_port(self) -> Port:
        self.port = LazyPort(super().open_port())
        return self.port


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def test_a_motion_that_is_taken_and_not_made_ends_and_blocks_nobody(stage: Stage) -> None:
    body = LazyHardware("bea")
    node = Node(Roads.open(lambda: zbus.connect(stage.endpoint)), "bea", body)
    try:
        robot = ready(stage.robot("bea", "hw"))
        with pytest.raises(Interrupted, match="does not make it") as ended:
            robot.look(yaw=5, speed=60)
        assert ended.value.reason is Reason.BOARD_LOST
        assert robot.stop().result
        body.port.lazy = False
        robot.look(yaw=5, speed=60)
        assert robot.positions().commanded.short == pytest.approx(5, abs=0.1)
    finally:
        node.close()
