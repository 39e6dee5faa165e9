"""A faulty board that drops or does not acknowledge motions: the client gets a correct error."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest
from msgspec.structs import replace
from robots import Stage, assert_fails, ready, until
from ticking_board import RealTimeTicker

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware, VirtualBoard
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import BoardState, FrameType, Telemetry
from hw_node.body import Hardware

MOVES = (FrameType.MOVE, FrameType.MOVE_STRAIGHT)


class FaultyPort:
    """The port of a faulty board.

    `drops_moves`: it acknowledges MOVE and does not carry it out. `no_acks`: it carries out MOVE and does not
    acknowledge it. `always_moving`: its telemetry always reports MOVING.
    """

    name = "faulty:"
    boot_s = 0.0

    def __init__(self) -> None:
        self.board = VirtualBoard(Firmware(boot=1, name="bea"))
        self._decoder = Decoder()
        self._sent = b""
        self.drops_moves, self.no_acks, self.always_moving = True, False, False
        self._answers = Decoder()

    def write(self, data: bytes) -> bytes:
        for frame in self._decoder.feed(data):
            if self.drops_moves and frame.type in MOVES:
                self._sent += encode(frame.type | FrameType.ACK, frame.seq, b"\0")
            else:
                self.board.write(encode(*frame))
        return b""

    def wake(self) -> None:
        self.board.wake()

    def read(self, timeout_s: float) -> bytes:
        sent, self._sent = self._sent, b""
        for frame in self._answers.feed(self.board.read(timeout_s)):
            payload = frame.payload
            if self.always_moving and frame.type == FrameType.TELEMETRY:
                telemetry = Telemetry.unpack(payload)
                payload = replace(telemetry, state=telemetry.state | BoardState.MOVING).pack()
            if not self.no_acks or frame.type & ~FrameType.ACK not in MOVES:
                sent += encode(frame.type, frame.seq, payload)
        return sent

    def close(self) -> None:
        """Keep the board running."""


@pytest.fixture
def faulty(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[FaultyPort, Robot]]:
    """A robot with its motors on and calibrated, on a faulty board."""
    port, hardware = FaultyPort(), Hardware(FaultyPort.name)
    monkeypatch.setattr(hardware, "open_port", lambda: port)
    with Stage() as stage, contextlib.closing(RealTimeTicker(port.board)):
        stage.node("bea", hardware)
        yield port, ready(stage.robot("bea", "hw"))
        stage.end_nodes()


def test_an_acknowledged_motion_that_is_not_made_ends_and_blocks_no_other(
    faulty: tuple[FaultyPort, Robot],
) -> None:
    port, robot = faulty
    assert_fails(lambda: robot.look(yaw=5, speed=60), Interrupted, Reason.BOARD_LOST, "does not carry it out")
    assert robot.stop().result
    port.drops_moves = False
    robot.look(yaw=5, speed=60)
    assert robot.positions().commanded.short == pytest.approx(5, abs=0.1)


def test_an_unacknowledged_motion_that_is_made_is_stopped(faulty: tuple[FaultyPort, Robot]) -> None:
    port, robot = faulty
    port.drops_moves, port.no_acks = False, True
    assert_fails(lambda: robot.look(yaw=90), Refused, Reason.BOARD_LOST, "does not answer")
    until(lambda: not robot.status().moving, "at rest")
    assert robot.positions().commanded.short < 45


def test_stop_fails_if_the_board_never_comes_to_rest(faulty: tuple[FaultyPort, Robot]) -> None:
    port, robot = faulty
    port.drops_moves, port.always_moving = False, True
    until(lambda: robot.status().moving, "moving, by its status")
    advice = r"^NOT stopped\. .*reports that the arms still move.*motor power off"
    assert_fails(robot.stop, Refused, Reason.FAULT, advice)
    port.always_moving = False
    until(lambda: not robot.status().moving, "at rest")
    assert robot.stop().result
