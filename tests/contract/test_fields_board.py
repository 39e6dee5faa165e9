"""BoardStatus while the connection to the board is disturbed, on the bodies whose connection a test can disturb."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import pytest
from published import at_once, published_statuses, regular, without_clocks
from robots import Process, Stage, ready
from threaded_board import ThreadedHardware

from beatrix_zenoh import Robot
from beatrix_zenoh.board.link import Decoder
from beatrix_zenoh.board.state import Port
from beatrix_zenoh.contract._generated.messages import Fault
from beatrix_zenoh.contract._generated.serial import FrameType

LOST_NS = 0.5e9
"""Longest time after the last byte of a board until it counts as lost (ns)."""
NOISE = b"\x05noise\0"


@dataclass
class Cable:
    """A robot whose connection to a simulated Mega or a virtual board can be disturbed."""

    robot: Robot
    mega: Process | None
    frozen: bool = False
    swallowing: bool = False
    noise: list[bytes] = field(default_factory=list)

    def freeze(self, *, frozen: bool) -> None:
        """Suspend the board, or let it continue."""
        self._send("freeze" if frozen else "go")
        self.frozen = frozen

    def swallow(self) -> None:
        """Lose the next request, or the answer to it."""
        self._send("swallow")
        self.swallowing = True

    def _send(self, word: str) -> None:
        if self.mega is not None:
            self.mega.say(word)
            self.mega.expect(word)

    def patch(self, board: Port, monkeypatch: pytest.MonkeyPatch) -> None:
        """Disturb the bytes between a node of this process and its virtual board."""
        read, write = board.read, board.write

        def disturbed_read(timeout_s: float) -> bytes:
            noise = self.noise.pop() if self.noise else b""
            data = noise + read(timeout_s)
            return b"" if self.frozen else data

        def disturbed_write(data: bytes) -> bytes:
            request = any(frame.type != FrameType.PING for frame in Decoder().feed(data))
            if self.swallowing and request:
                self.swallowing = False
                return b""
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


@pytest.mark.measures_time
def test_retries_and_rejected_frames_are_counted_and_published_at_once(cable: Cable) -> None:
    statuses = published_statuses(cable.robot)

    def count(field: str, act: Callable[[], object]) -> None:
        before = regular(statuses)
        act()
        done_ns = time.monotonic_ns()
        was = getattr(before.board, field)
        after = statuses.next(lambda status: getattr(status.board, field) != was)
        assert getattr(after.board, field) == was + 1
        at_once(after, done_ns)
        board = msgspec.structs.replace(after.board, **{field: was})
        assert without_clocks(msgspec.structs.replace(after, board=board)) == without_clocks(before)

    cable.swallow()
    count("retries", cable.robot.enable)
    if cable.mega is None:
        count("rejected_frames", lambda: cable.noise.append(NOISE))
