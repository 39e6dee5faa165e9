"""Requests to the board: retries, concurrent callers, firmware of another contract, loss and reconnection."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import pytest
from robots import until
from ticking_board import RealTimeTicker

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh.board.board import Board
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.timing import LOADER_S
from beatrix_zenoh.board.virtual import Firmware, VirtualBoard
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    FrameType,
    HelloReply,
    MoveStraight,
    Text,
    TextWarning,
)

FOREIGN = HelloReply(0xBAD, (0, 9, 1), 1, b"old".ljust(32, b"\0"))


class LossyPort:
    """A virtual board whose wire can lose, delay or forge frames to the host."""

    name = "lossy:"
    boot_s = 0.0

    def __init__(self, board: VirtualBoard) -> None:
        self.board = board
        self.lose: list[int] = []
        self.unplugged = self.mute = False
        self.free = threading.Event()
        self.free.set()
        self.forged = b""
        self.instead = b""
        """Bytes that `read` returns instead of each lost frame."""
        self._decoder = Decoder()

    def write(self, data: bytes) -> bytes:
        if self.unplugged:
            raise OSError("unplugged")
        self.board.write(data)
        return b""  # replies are returned by `read`

    def wake(self) -> None:
        self.board.wake()

    def read(self, timeout_s: float) -> bytes:
        self.free.wait(10)
        if self.unplugged:
            raise OSError("unplugged")
        out, self.forged = self.forged, b""
        for frame in self._decoder.feed(self.board.read(timeout_s)):
            if self.mute:
                continue
            if frame.type in self.lose:
                self.lose.remove(frame.type)
                out += self.instead
            else:
                out += encode(frame.type, frame.seq, frame.payload)
        return out

    def close(self) -> None:
        """Keep the board running."""


class Rig:
    """A Board on a lossy wire."""

    def __init__(self) -> None:
        self.virtual = VirtualBoard(Firmware(boot=1, name="bea"))
        self.ticker = RealTimeTicker(self.virtual)
        self.port = LossyPort(self.virtual)
        self.board = Board(lambda: self.port, lambda _: None, lambda: None)
        self.board.start()
        assert self.board.wait_for(lambda _: True, 2.0)

    def rest(self) -> tuple[int, int, int]:
        """Wait until no arm has stepped for 0.2 s; return the positions of the arms."""
        seen: list[tuple[int, int, int]] = []

        def at_rest() -> bool:
            with self.virtual.lock:
                seen.append(self.virtual.firmware.steps())
            return len(seen) > 20 and seen[-1] == seen[-21]

        until(at_rest, "at rest")
        return seen[-1]

    def lost(self) -> None:
        """Wait until the board counts as lost."""
        until(lambda: not self.board.connected, "lost")

    def close(self) -> None:
        self.board.close()
        self.ticker.close()
        self.virtual.close()


@pytest.fixture
def rig() -> Iterator[Rig]:
    made = Rig()
    yield made
    made.close()


def test_one_lost_reply_causes_one_retry(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80]
    rig.board.enable(on=True)
    assert rig.board.retries == 1
    assert rig.board.connected


def test_a_reply_lost_at_every_try_raises_board_lost(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80] * 10
    with pytest.raises(NoAnswer, match="does not answer") as loss:
        rig.board.enable(on=True)
    assert loss.value.reason is Reason.BOARD_LOST


def test_a_late_reply_is_not_matched_to_the_next_request(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80] * 3
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    rig.port.lose = [FrameType.ENABLE | 0x80] * 3
    rig.port.instead = encode(FrameType.ENABLE | 0x80, rig.board._seq, b"\0")
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    assert not rig.board._pending


def test_a_refusal_by_the_firmware_keeps_its_reason(rig: Rig) -> None:
    with pytest.raises(Refused, match="motors are off") as refusal:
        rig.board.move(MoveStraight(1, (0, 0, 0), 400))
    assert refusal.value.reason is Reason.NOT_ENABLED


def connect_foreign(rig: Rig) -> None:
    """Forge each HELLO_REPLY with another contract, and wait until the board has read one."""
    rig.port.instead = encode(FrameType.HELLO_REPLY, 0, FOREIGN.pack())
    rig.port.lose = [FrameType.HELLO_REPLY] * 1000
    while rig.board.understood:
        rig.port.forged = rig.port.instead
        rig.board.wait_for(lambda _: not rig.board.understood, 0.1)


def test_requests_to_firmware_of_another_contract_raise_contract_mismatch(rig: Rig) -> None:
    connect_foreign(rig)
    expected = r"00000bad.*another version.*built for another robot.*`beatrix flash`"
    with pytest.raises(NoAnswer, match=expected) as refusal:
        rig.board.enable(on=True)
    assert refusal.value.reason is Reason.CONTRACT_MISMATCH
    with pytest.raises(NoAnswer, match=expected):
        rig.board.send_text(b"@ENMOTORS ON")


def test_firmware_of_another_contract_can_be_stopped(rig: Rig) -> None:
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 400))
    connect_foreign(rig)
    rig.board.request(FrameType.STOP)
    assert rig.rest() < (500, 500, 500)
    rig.board.request(FrameType.EMERGENCY_STOP)


def test_the_handshake_is_repeated_after_a_loss(rig: Rig) -> None:
    """Even with the same boot number, the board may have been replaced by one with another contract."""
    rig.port.unplugged = True
    rig.lost()
    assert rig.board.hello is None
    with pytest.raises(NoAnswer) as refusal:
        rig.board.enable(on=True)
    assert refusal.value.reason is Reason.BOARD_LOST
    rig.port.unplugged = False
    rig.board.wait_for(lambda _: rig.board.connected, 10.0)
    assert rig.board.hello is not None


def test_only_a_reply_to_the_request_answers_it(rig: Rig) -> None:
    rig.port.lose = [FrameType.STOP | 0x80] * 10
    unasked = [
        (FrameType.TEXT, Text(1, b"ACK\n").pack()),
        (FrameType.TEXT_WARNING, TextWarning(5).pack()),
        (0xFF, b"0"),
        (FrameType.ENABLE | 0x80, b"\0"),
    ]
    rig.port.instead = b"".join(encode(kind, seq, data) for kind, data in unasked for seq in range(1, 256))
    with pytest.raises(NoAnswer, match="does not answer"):
        rig.board.request(FrameType.STOP)
    assert rig.board.connected


def test_a_reset_is_detected_by_the_boot_number(rig: Rig) -> None:
    rig.board.enable(on=True)
    with rig.virtual.lock:
        rig.virtual.firmware = Firmware(boot=2, name="bea")
    assert rig.board.wait_for(lambda telemetry: telemetry.boot == 2, 10.0)
    assert rig.board.hello is not None
    assert rig.board.hello.boot == 2


@pytest.mark.long("waits in real time")
def test_board_time_pauses_while_the_reader_thread_does_not_run(rig: Rig) -> None:
    """On a busy computer one thread may not run for a second, although the host still exists."""
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 1600))
    rig.port.free.clear()
    assert rig.rest() < (500, 500, 500)
    rig.port.free.set()
    assert rig.board.wait_for(lambda telemetry: telemetry.position == (500, 500, 500), 5.0)


def test_a_board_whose_host_receives_nothing_stops_its_motion(rig: Rig) -> None:
    """HELLO must be sent too rarely to act as a heartbeat, because the node no longer observes the board."""
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (1500, 1500, 1500), 800))
    rig.port.mute = True
    rig.rest()
    rig.lost()
    rig.port.mute = False
    assert rig.board.wait_for(lambda telemetry: telemetry.outcome == BoardOutcome.HOST_LOST, 10.0)
    assert rig.board.telemetry is not None
    assert 0 < rig.board.telemetry.position[0] < 500


def test_stop_is_sent_to_a_lost_board_and_postpones_its_handshake(rig: Rig) -> None:
    rig.port.mute = True
    rig.lost()
    sent = time.monotonic()
    with pytest.raises(NoAnswer, match="does not answer"):
        rig.board.request(FrameType.STOP)
    assert not rig.board._handshake.due(sent + LOADER_S + 0.1), (
        "the request is sent three times, the last 0.2 s after the first"
    )
    rig.port.mute = False
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    rig.board.request(FrameType.STOP)
    until(lambda: rig.board.connected, "found again")
    assert time.monotonic() - sent < LOADER_S, "the reply showed that the firmware runs"
