"""BoardStatus while the connection to the board is cut."""

from __future__ import annotations

import time

import pytest
from published import at_once, published_statuses, regular
from robots import Stage, ready
from threaded_board import ThreadedHardware

from beatrix_zenoh import Robot
from beatrix_zenoh.board.state import Port
from beatrix_zenoh.contract._generated.messages import Fault

LOST_NS = 0.5e9
"""Longest time after the last byte of a board until it counts as lost (ns)."""


class Cable:
    """The connection of a virtual board, which can be cut."""

    def __init__(self, board: Port, monkeypatch: pytest.MonkeyPatch) -> None:
        self.cut = False
        self._read, self._write = board.read, board.write
        monkeypatch.setattr(board, "read", self.read)
        monkeypatch.setattr(board, "write", self.write)

    def read(self, timeout_s: float) -> bytes:
        data = self._read(timeout_s)
        return b"" if self.cut else data

    def write(self, data: bytes) -> bytes:
        return b"" if self.cut else self._write(data)


@pytest.mark.measures_time
def test_connected_follows_the_board_and_is_published_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    with Stage() as stage:
        body = ThreadedHardware("bea")
        stage.node("bea", body)
        check_a_lost_board(ready(stage.robot("bea", "hw")), Cable(body.open_port(), monkeypatch))


def check_a_lost_board(robot: Robot, cable: Cable) -> None:
    statuses = published_statuses(robot)
    before = regular(statuses)
    frozen_ns = time.monotonic_ns()
    cable.cut = True
    lost = statuses.next(lambda status: not status.board.connected)
    at_once(lost, frozen_ns + LOST_NS)
    assert (lost.enabled, lost.calibrated, lost.moving) == (False, False, False), (
        "the state of a lost board is unknown"
    )
    assert lost.fault is Fault.BOARD_LOST
    assert any("silent" in warning for warning in lost.warnings)
    assert (lost.board.port, lost.board.boot) in {
        (before.board.port, 0),
        (before.board.port, before.board.boot),
    }
    cable.cut = False
    back = statuses.next(lambda status: status.board.connected)
    assert back.fault is Fault.NONE
    assert back.board.boot == before.board.boot
    assert back.board.firmware == before.board.firmware
