"""A board that takes a motion and does not make it, or makes it and does not say so: whoever asked is told the truth."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pytest
from stage import Stage, ready, until

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh import bus as zbus
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import FrameType, State, Telemetry
from beatrix_zenoh.board.board import Port
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.node import Node, Roads
from hw_node.body import VirtualHardware

MOVES = (FrameType.MOVE, FrameType.MOVE_STRAIGHT)


class LazyPort:
    """A port whose board acknowledges MOVE and forgets it, while it is lazy, or makes it and never says so, while it is sullen; restless, it says that it moves."""

    name = "lazy:"
    boot_s = 0.0

    def __init__(self, port: Port) -> None:
        self._port = port
        self._decoder = Decoder()
        self._said = b""
        self.lazy, self.sullen, self.restless = True, False, False
        self._answers = Decoder()

    def write(self, data: bytes) -> None:
        for frame in self._decoder.feed(data):
            if self.lazy and frame.type in MOVES:
                self._said += encode(frame.type | FrameType.ACK, frame.seq, b"\0")
            else:
                self._port.write(encode(frame.type, frame.seq, frame.payload))

    def read(self, timeout_s: float) -> bytes:
        said, self._said = self._said, b""
        for frame in self._answers.feed(self._port.read(timeout_s)):
            payload = frame.payload
            if self.restless and frame.type == FrameType.TELEMETRY:
                telemetry = Telemetry.unpack(payload)
                payload = telemetry._replace(state=telemetry.state | State.MOVING).pack()
            if not self.sullen or frame.type & ~FrameType.ACK not in MOVES:
                said += encode(frame.type, frame.seq, payload)
        return said

    def close(self) -> None:
        """The board behind stays."""


class LazyHardware(VirtualHardware):
    def open_port(self) -> Port:
        self.port = LazyPort(super().open_port())
        return self.port


class Told(NamedTuple):
    body: LazyHardware
    robot: Robot


@pytest.fixture
def told() -> Iterator[Told]:
    """A robot with its motors on and calibrated, on a lazy board."""
    with Stage() as stage:
        body = LazyHardware("bea")
        node = Node(Roads.open(lambda: zbus.connect(stage.endpoint)), "bea", body)
        try:
            yield Told(body, ready(stage.robot("bea", "hw")))
        finally:
            node.close()


def test_a_motion_that_is_taken_and_not_made_ends_and_blocks_nobody(told: Told) -> None:
    body, robot = told
    with pytest.raises(Interrupted, match="does not make it") as ended:
        robot.look(yaw=5, speed=60)
    assert ended.value.reason is Reason.BOARD_LOST
    assert robot.stop().result
    body.port.lazy = False
    robot.look(yaw=5, speed=60)
    assert robot.positions().commanded.short == pytest.approx(5, abs=0.1)


def test_a_motion_that_is_made_and_never_acknowledged_is_stopped(told: Told) -> None:
    body, robot = told
    body.port.lazy, body.port.sullen = False, True
    with pytest.raises(Refused, match="does not answer") as refused:
        robot.look(yaw=90)
    assert refused.value.reason is Reason.BOARD_LOST
    until(lambda: not robot.status().moving, "at rest", 1.5)
    assert robot.positions().commanded.short < 45


def test_stop_to_a_board_that_never_comes_to_rest_is_answered_as_not_stopped(told: Told) -> None:
    body, robot = told
    body.port.lazy, body.port.restless = False, True
    until(lambda: robot.status().moving, "it says so")
    with pytest.raises(
        Refused, match=r"^NOT stopped\. .*says that the arms still move.*motor power off"
    ) as refused:
        robot.stop()
    assert refused.value.reason is Reason.FAULT
    body.port.restless = False
    until(lambda: not robot.status().moving, "it says so")
    assert robot.stop().result
