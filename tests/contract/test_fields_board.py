"""BoardStatus while the connection to the board is disturbed, on the bodies whose connection a test can disturb."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from published import at_once, published_statuses, regular
from robots import Process, Stage, ready
from threaded_board import ThreadedHardware

from beatrix_zenoh import Robot
from beatrix_zenoh.board.state import Port
from beatrix_zenoh.contract._generated.messages import Fault

LOST_NS = 0.5e9
"""Longest time after the last byte of a board until it counts as lost (ns)."""


@dataclass
class Cable:
    """A robot whose connection to a simulated Mega or a virtual board can be disturbed."""

    robot: Robot
    mega: Process | None
    frozen: bool = False

    def freeze(self, *, frozen: bool) -> None:
        """Suspend the board, or let it continue."""
        self._send("freeze" if frozen else "go")
        self.frozen = frozen

    def _send(self, word: str) -> None:
        if self.mega is not None:
            self.mega.say(word)
            self.mega.expect(word)

    def patch(self, board: Port, monkeypatch: pytest.MonkeyPatch) -> None:
        """Disturb the bytes between a node of this process and its virtual board."""
        read, write = board.read, board.write

        def disturbed_read(timeout_s: float) -> bytes:
            data = read(timeout_s)
            return b"" if self.frozen else data

        def disturbed_write(data: bytes) -> bytes:
            return b"" if self.frozen else write(data)

        monkeypatch.setattr(board, "read", disturbed_read)
        monkeypatch.setattr(board, "write", disturbed_write)


@pytest.fixture(
    params=["in-process", pytest.param("mega", marks=pytest.mark.long("firmware of the Mega in real time"))]
)
def cable(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Cable]:
    with Stage() as stage:
        if request.param == "mega":
            mega = stage.mega(tmp_path / "board")
            stage.hardware("bea", str(tmp_path / "board"))
            yield Cable(ready(stage.robot("bea", "hw")), mega)
        else:
            body = ThreadedHardware("bea")
            stage.node("bea", body)
            cable = Cable(ready(stage.robot("bea", "hw")), None)
            cable.patch(body.open_port(), monkeypatch)
            yield cable


@pytest.mark.measures_time
def test_connected_follows_the_board_and_is_published_at_once(cable: Cable) -> None:
    statuses = published_statuses(cable.robot)
    before = regular(statuses)
    frozen_ns = time.monotonic_ns()
    cable.freeze(frozen=True)
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
    cable.freeze(frozen=False)
    back = statuses.next(lambda status: status.board.connected)
    assert back.fault is Fault.NONE
    assert back.board.boot == before.board.boot
    assert back.board.firmware == before.board.firmware
