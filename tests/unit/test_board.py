"""Requests to the board: a lost reply costs one retry, two callers never get each other's answer."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator

import pytest
from stage import until

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh._generated.serial import (
    Error,
    FrameType,
    HelloReply,
    MoveStraight,
    Outcome,
    State,
    Telemetry,
    Text,
    TextWarning,
)
from beatrix_zenoh.board.board import Board, unheard
from beatrix_zenoh.board.greeting import LOADER_S
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware, RealTimeTicker, VirtualBoard


class LossyPort:
    """A virtual board whose wire can lose, delay or forge frames to the host."""

    name = "lossy:"
    boot_s = 0.0

    def __init__(self, board: VirtualBoard) -> None:
        self.board = board
        self.lose: list[int] = []
        self.gone = self.mute = False
        self.free = threading.Event()
        self.free.set()
        self.forged = b""
        self.instead = b""
        """Comes in the place of every frame that is lost."""
        self._decoder = Decoder()

    def write(self, data: bytes) -> None:
        if self.gone:
            raise OSError("gone")
        self.board.write(data)

    def read(self, timeout_s: float) -> bytes:
        self.free.wait(10)
        if self.gone:
            raise OSError("gone")
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
        """The board behind stays."""


class Rig:
    """A board on a lossy wire, and what it reported."""

    def __init__(self) -> None:
        self.virtual = VirtualBoard(Firmware(boot=1, name="bea"))
        self.ticker = RealTimeTicker(self.virtual)
        self.port = LossyPort(self.virtual)
        self.heard: list[Telemetry] = []
        self.link_changes = 0
        self.board = Board(lambda: self.port, self.heard.append, self._changed)
        self.board.start()
        assert self.board.wait_for(lambda _: True, 2.0)

    def _changed(self) -> None:
        self.link_changes += 1

    def steps(self) -> tuple[int, int, int]:
        """Where the firmware has the arms."""
        with self.virtual.lock:
            return self.virtual.firmware.steps()

    def rest(self) -> tuple[int, int, int]:
        """Wait until no arm has stepped for 0.2 s; where they are then."""
        seen: list[tuple[int, int, int]] = []

        def at_rest() -> bool:
            seen.append(self.steps())
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


def test_one_lost_reply_costs_one_retry(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80]
    rig.board.enable(on=True)
    assert rig.board.link.retries == 1
    assert rig.board.link.connected


def test_a_reply_lost_every_time_is_a_lost_board(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80] * 10
    with pytest.raises(NoAnswer, match="does not answer") as loss:
        rig.board.enable(on=True)
    assert loss.value.reason is Reason.BOARD_LOST


def test_an_answer_that_comes_late_is_not_taken_for_the_next_ones(rig: Rig) -> None:
    rig.port.lose = [FrameType.ENABLE | 0x80] * 3
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    rig.port.lose = [FrameType.ENABLE | 0x80] * 3
    rig.port.instead = encode(FrameType.ENABLE | 0x80, rig.board._seq, b"\0")
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    assert not rig.board._pending


def test_two_callers_at_once_never_get_each_others_answer(rig: Rig) -> None:
    """STOP always succeeds, CALIBRATE with motors off never does: a mixed-up answer would show."""
    mixed: list[str] = []

    def stop() -> None:
        for _ in range(200):
            try:
                rig.board.request(FrameType.STOP)
            except Refused as error:
                mixed.append(error.message)

    def calibrate() -> None:
        for _ in range(200):
            try:
                rig.board.request(FrameType.CALIBRATE)
            except Refused:
                continue
            mixed.append("calibrated with motors off")

    threads = [threading.Thread(target=work) for work in (stop, calibrate)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert mixed == []


def test_the_firmwares_refusal_keeps_its_reason(rig: Rig) -> None:
    with pytest.raises(Refused, match="motors are off") as refusal:
        rig.board.move(MoveStraight(1, (0, 0, 0), 400))
    assert refusal.value.reason is Reason.NOT_ENABLED


def test_firmware_of_another_contract_is_named_and_not_moved(rig: Rig) -> None:
    stranger = HelloReply(0xBAD, (0, 9, 1), 1, b"old".ljust(32, b"\0"))
    rig.port.forged = encode(FrameType.HELLO_REPLY, 0, stranger.pack())
    while rig.board.link.understood:
        rig.board.wait_for(lambda _: not rig.board.link.understood, 0.1)
    asks: list[Callable[[], None]] = [
        lambda: rig.board.enable(on=True),
        lambda: rig.board.send_text(b"@ENMOTORS ON"),
    ]
    told = r"00000bad.*another version.*built for another robot.*`beatrix flash`"
    for ask in asks:
        with pytest.raises(NoAnswer, match=told) as refusal:
            ask()
        assert refusal.value.reason is Reason.CONTRACT_MISMATCH


def test_firmware_whose_telemetry_cannot_be_read_is_named_not_called_silent() -> None:
    """Its frames may have other lengths: nothing but HELLO and the stops are the same in all versions."""
    port = LossyPort(VirtualBoard(Firmware(boot=1)))
    stranger = HelloReply(0xBAD, (0, 9, 1), 1, b"old".ljust(32, b"\0"))
    port.lose = [FrameType.HELLO_REPLY] * 100
    port.instead = encode(FrameType.HELLO_REPLY, 0, stranger.pack())
    board = Board(lambda: port, lambda _: None, lambda: None)
    board.start()
    try:
        assert not board.wait_for(lambda _: True, 0.5)  # time stands still there: no telemetry
        assert "00000bad" in board.link.trouble
        refusal = unheard(board.link)
        assert (refusal.reason, "beatrix flash" in refusal.message) == (Reason.CONTRACT_MISMATCH, True)
        board.request(FrameType.STOP)
    finally:
        board.close()


def test_firmware_of_another_contract_can_be_stopped(rig: Rig) -> None:
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 400))
    stranger = HelloReply(0xBAD, (0, 9, 1), 1, b"old".ljust(32, b"\0"))
    rig.port.forged = encode(FrameType.HELLO_REPLY, 0, stranger.pack())
    while rig.board.link.understood:
        rig.board.wait_for(lambda _: not rig.board.link.understood, 0.1)
    rig.board.request(FrameType.STOP)
    assert rig.rest() < (500, 500, 500)
    rig.board.request(FrameType.EMERGENCY_STOP)


def test_a_board_that_was_started_more_often_than_telemetry_counts_is_found() -> None:
    virtual = VirtualBoard(Firmware(boot=2**16 + 300))
    ticker = RealTimeTicker(virtual)
    board = Board(lambda: LossyPort(virtual), lambda _: None, lambda: None)
    board.start()
    try:
        assert board.wait_for(lambda telemetry: telemetry.boot == 300, 2.0)
        assert (board.link.connected, board.link.boot) == (True, 2**16 + 300)
    finally:
        board.close()
        ticker.close()


def test_another_board_at_the_port_is_greeted_whatever_the_first_was(rig: Rig) -> None:
    """Even where its boot number is the same: else it would be taken for the first, of another contract or not."""
    rig.port.gone = True
    rig.lost()
    assert rig.board.link.hello is None
    with pytest.raises(NoAnswer) as refusal:
        rig.board.enable(on=True)
    assert refusal.value.reason is Reason.BOARD_LOST
    rig.port.gone = False
    rig.board.wait_for(lambda _: rig.board.link.connected, 3.0)
    assert rig.board.link.hello is not None


def test_text_is_no_heartbeat(rig: Rig) -> None:
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 1600))
    while not rig.board.wait_for(lambda telemetry: not telemetry.state & State.MOVING, 0.02):
        rig.board.send_text(b"@GETXPOS")
    assert rig.heard[-1].position == (500, 500, 500)


def test_text_for_a_board_that_is_not_there_is_refused(rig: Rig) -> None:
    rig.port.gone = True
    pause = threading.Event()
    while rig.board.link.connected:
        pause.wait(0.01)
    with pytest.raises(NoAnswer, match="does not hear its board"):
        rig.board.send_text(b"@GETXPOS")


def test_a_silent_board_is_lost_within_moments(rig: Rig) -> None:
    rig.port.lose = [FrameType.TELEMETRY] * 10000
    began_s = time.monotonic()
    pause = threading.Event()
    while rig.board.link.connected:
        rig.port.lose += [kind | 0x80 for kind in (FrameType.PING, FrameType.HELLO)]
        pause.wait(0.01)
    assert time.monotonic() - began_s < 3, "half a second, on a busy machine more"


def test_an_unknown_error_code_is_a_refusal_not_a_crash(rig: Rig) -> None:
    rig.port.lose = [FrameType.STOP | 0x80] * 3
    errors: list[Refused] = []

    def request() -> None:
        try:
            rig.board.request(FrameType.STOP)
        except Refused as error:
            errors.append(error)

    thread = threading.Thread(target=request)
    thread.start()
    for seq in range(1, 30):
        rig.port.forged += encode(FrameType.STOP | 0x80, seq, bytes([max(Error) + 40]))
    thread.join()
    assert "unknown error" in errors[0].message


def test_what_the_board_says_unasked_answers_no_request(rig: Rig) -> None:
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
    assert rig.board.link.connected


def test_a_port_that_goes_and_comes_is_found_again(rig: Rig) -> None:
    rig.port.gone = True
    rig.lost()
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    rig.port.gone = False
    until(lambda: rig.board.connected, "found again")
    rig.board.enable(on=True)
    assert rig.link_changes >= 3


def test_a_reset_board_is_noticed_by_its_boot_number(rig: Rig) -> None:
    rig.board.enable(on=True)
    with rig.virtual.lock:
        rig.virtual.firmware = Firmware(boot=2, name="bea")
    assert rig.board.wait_for(lambda telemetry: telemetry.boot == 2, 3.0)
    assert rig.board.link.hello is not None
    assert rig.board.link.hello.boot == 2


def test_the_heartbeat_keeps_an_idle_host_moving(rig: Rig) -> None:
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 1600))
    assert rig.board.wait_for(lambda telemetry: telemetry.position == (500, 500, 500), 5.0)


def test_a_host_whose_thread_is_forgotten_for_a_second_is_waited_for(rig: Rig) -> None:
    """A busy computer may let one thread of many stand still; nobody has gone."""
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (500, 500, 500), 800))
    rig.port.free.clear()
    assert rig.rest() < (500, 500, 500)
    rig.port.free.set()
    assert rig.board.wait_for(lambda telemetry: telemetry.position == (500, 500, 500), 5.0)


def test_a_board_that_is_not_heard_misses_its_host_and_stops(rig: Rig) -> None:
    """It must not take a greeting for a heartbeat: nobody sees any more what it does."""
    rig.board.enable(on=True)
    rig.board.request(FrameType.CALIBRATE)
    rig.board.move(MoveStraight(7, (1500, 1500, 1500), 800))
    rig.port.mute = True
    rig.rest()
    rig.lost()
    rig.port.mute = False
    assert rig.board.wait_for(lambda telemetry: telemetry.outcome == Outcome.HOST_LOST, 3.0)
    assert rig.board.telemetry is not None
    assert 0 < rig.board.telemetry.position[0] < 500


def test_stop_goes_to_a_lost_board_and_puts_off_its_greeting(rig: Rig) -> None:
    rig.port.mute = True
    rig.lost()
    asked = time.monotonic()
    with pytest.raises(NoAnswer, match="does not answer"):
        rig.board.request(FrameType.STOP)
    assert not rig.board._greeting.due(asked + LOADER_S + 0.1), "asked three times, the last 0.2 s later"
    rig.port.mute = False
    with pytest.raises(NoAnswer):
        rig.board.enable(on=True)
    rig.board.request(FrameType.STOP)
    until(lambda: rig.board.connected, "found again")
    assert time.monotonic() - asked < LOADER_S, "its answer showed that firmware runs"
