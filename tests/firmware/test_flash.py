"""`beatrix flash` with the real boot loader of the Arduino Mega, on the simulated board."""

from __future__ import annotations

import os
import random
import signal
import tty
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import pytest
from avr.bench import Avr
from avr.mega import HEX, LOADER
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console
from rich.progress import Progress

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import CONTRACT, FrameType, HelloReply
from beatrix_zenoh.contract.errors import WrongUsage
from hw_node import flash, stk500
from hw_node.port import SerialPort
from hw_node.stk500 import ERASE, FLASH, LEAVE, PAGE, PROGRAM, READ, SIGN_ON, SPI

IMAGE = flash.read_hex(flash.SHIPPED)
PAGES = -(-len(IMAGE) // PAGE)
CLOSE = 0
"""Pseudo-command: closing the port."""

Fault = Callable[[bytes], bytes]
"""Function that changes a message to the board, or raises."""


class BenchWire(SerialPort):
    """Serial line of the simulated board, in virtual time; can damage bytes in both directions.

    `spoil` is the probability that received bytes are damaged.
    `fault` receives the `nth` message with the command `at`; it returns a changed message or raises.
    """

    def __init__(
        self, avr: Avr, spoil: float = 0.0, at: int = -1, nth: int = 1, fault: Fault | None = None
    ) -> None:
        self.avr, self._spoil, self._at, self._left, self._fault = avr, spoil, at, nth, fault
        self._chance = random.Random(1)

    def reset_board(self) -> None:
        self.avr.reset()
        self.avr.byte_cycles = round(160_000_000 / stk500.BAUD)
        self.avr.receive()

    def write(self, data: bytes) -> bytes:
        self.avr.deliver(self._meet(data[5], data))
        return b""

    def _meet(self, command: int, data: bytes) -> bytes:
        self._left -= command == self._at
        return self._fault(data) if command == self._at and not self._left and self._fault else data

    def read(self, timeout_s: float) -> bytes:
        for _ in range(int(timeout_s * 1000) + 1):
            self.avr.run_ms(1)
            data = self.avr.receive()
            if data:
                return (
                    bytes([data[0] ^ 1 << self._chance.randrange(8)]) + data[1:]
                    if self._chance.random() < self._spoil
                    else data
                )
        return b""

    def close(self) -> None:
        self._meet(CLOSE, b"")


def pull(_: bytes) -> bytes:
    raise OSError("the cable is out")


def arriving(number: signal.Signals) -> Fault:
    """Return a fault: a signal arrives while a message is sent."""

    def raise_signal(data: bytes) -> bytes:
        signal.raise_signal(number)
        return data

    return raise_signal


def change(data: bytes) -> bytes:
    """Make two errors in the second half of a page that keep its XOR checksum."""
    spoilt = bytearray(data)
    spoilt[200] ^= 4
    spoilt[230] ^= 4
    return bytes(spoilt)


def put(wire: BenchWire) -> list[tuple[str, bool]]:
    """Flash the image as `flash.flash` does, without the search for a port; return the steps, and if they are done."""
    state = flash.UNTOUCHED
    with Progress(console=Console(file=StringIO())) as bar:
        try:
            for now in flash.program(wire, IMAGE, bar):
                state = now
        except (NoAnswer, OSError) as error:
            raise NoAnswer(Reason.BOARD_LOST, f"{error}. {state}") from error
    return [(task.description, task.completed == task.total == PAGES - 1) for task in bar.tasks]


def board() -> Avr:
    """Return a new Mega, which contains only the boot loader."""
    return Avr(LOADER, baud=stk500.BAUD)


def hello(avr: Avr) -> HelloReply | None:
    """Return the HELLO_REPLY of the firmware, or None without firmware."""
    avr.byte_cycles = 640
    avr.run_ms(1500)
    avr.receive()
    avr.deliver(encode(FrameType.HELLO, 1, b""))
    avr.run_ms(20)
    frames = [frame for frame in Decoder().feed(avr.receive()) if frame.type == FrameType.HELLO_REPLY]
    return HelloReply.unpack(frames[0].payload) if frames else None


SLOW = pytest.mark.long("flashes a board, cycle by cycle")


def test_a_new_board_answers_after_flashing_and_verification() -> None:
    with board() as avr:
        steps = put(BenchWire(avr))
        reply = hello(avr)
    assert reply is not None
    assert reply.contract == CONTRACT
    assert steps == [("Writing", True), ("Verifying", True)]


@SLOW
def test_flashing_succeeds_although_replies_are_damaged() -> None:
    with board() as avr:
        put(BenchWire(avr, spoil=0.005))
        assert hello(avr) is not None


@SLOW
@pytest.mark.parametrize(("command", "nth"), [(PROGRAM, 8), (READ, PAGES)])
def test_half_written_firmware_does_not_start_and_the_error_reports_it(command: int, nth: int) -> None:
    with board() as avr:
        put(BenchWire(avr))
        with pytest.raises(NoAnswer, match=r"cable is out.*incomplete firmware.*flash` again"):
            put(BenchWire(avr, at=command, nth=nth, fault=pull))
        avr.reset()
        assert hello(avr) is None
        assert not avr.enabled
        assert len(avr.edges("step")) == 0
        put(BenchWire(avr))
        assert hello(avr) is not None


AT_EDGES = [
    (SIGN_ON, 1, flash.UNTOUCHED, None),
    (SPI, 3, flash.UNTOUCHED, None),
    (ERASE, 1, flash.FIRST_PAGE, None),
    (PROGRAM, 1, flash.FIRST_PAGE, None),
    (READ, 1, flash.FIRST_PAGE, False),
    (PROGRAM, 2, flash.HALF_WRITTEN, False),
    (READ, PAGES + 1, flash.FIRST_PAGE, True),
    (LEAVE, 1, flash.COMPLETE, True),
    (CLOSE, 1, flash.COMPLETE, True),
]
"""Command, number of the message with it, state of the board if this message fails, whether firmware then starts."""
TYPICAL = AT_EDGES[1], AT_EDGES[5], AT_EDGES[8]
"""One of each state: untouched, half written, complete."""
ERROR = (pull, 1)
INTERRUPT, KILL, HANG_UP = (
    (arriving(number), 130) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
)


@pytest.mark.usefixtures("hangup")
@pytest.mark.parametrize(
    ("command", "nth", "state", "runs", "fault", "code"),
    [(*at, *ERROR) for at in TYPICAL]
    + [(*AT_EDGES[5], *KILL)]
    + [pytest.param(*at, *ERROR, marks=SLOW) for at in AT_EDGES if at not in TYPICAL]
    + [pytest.param(*AT_EDGES[5], *fault, marks=SLOW) for fault in (INTERRUPT, HANG_UP)],
)
def test_every_abort_prints_the_state_of_the_board(
    command: int,
    nth: int,
    state: str,
    runs: bool | None,
    fault: Fault,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with board() as avr:
        wire = BenchWire(avr, at=command, nth=nth, fault=fault)
        monkeypatch.setattr(flash, "SerialPort", lambda *_: wire)
        assert flash.main(["--port", "bench"]) == code
        assert capsys.readouterr().err.endswith(f"{state}\n")
        if runs is not None:  # None: the board has no firmware yet, so this is not checked
            avr.reset()
            assert (hello(avr) is not None) == runs


@pytest.mark.parametrize(
    ("nth", "state"),
    [
        (1, flash.FIRST_PAGE),
        (PAGES // 2, flash.HALF_WRITTEN),
        pytest.param(PAGES, flash.HALF_WRITTEN, marks=SLOW),
        pytest.param(PAGES + 1, flash.FIRST_PAGE, marks=SLOW),
    ],
)
def test_a_wrongly_written_page_is_detected_and_the_firmware_does_not_start(nth: int, state: str) -> None:
    with board() as avr:
        with pytest.raises(NoAnswer, match="reads back other bytes") as failed:
            put(BenchWire(avr, at=PROGRAM, nth=nth, fault=change))
        assert failed.value.message.endswith(state)
        if state == flash.HALF_WRITTEN:
            avr.reset()
            assert hello(avr) is None


def test_a_board_without_boot_loader_is_not_written() -> None:
    with (
        Avr(HEX) as avr,
        pytest.raises(NoAnswer, match=r"does not answer.*is an Arduino Mega.*Nothing was written"),
    ):
        put(BenchWire(avr))


def test_a_port_without_a_reset_line_is_rejected(capsys: pytest.CaptureFixture[str]) -> None:
    master, slave = os.openpty()
    tty.setraw(slave)
    assert flash.main(["--port", os.ttyname(slave)]) == 1
    errors = capsys.readouterr().err
    assert errors.endswith(
        f"has no reset line, so it is not the USB port of an Arduino. Name that port with --port. {flash.UNTOUCHED}\n"
    )
    os.close(master)
    os.close(slave)


@given(noise=st.binary(max_size=40), body=st.binary(min_size=1, max_size=300), sequence=st.integers(0, 255))
def test_a_reply_is_found_in_noise_and_a_damaged_one_is_ignored(
    noise: bytes, body: bytes, sequence: int
) -> None:
    message = bytes([0x1B, sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
    check = 0
    for byte in message:
        check ^= byte
    assert stk500.find(message + bytes([check]), sequence) == body
    assert stk500.find(message + bytes([check ^ 1]), sequence) is None
    assert stk500.find(noise.replace(b"\x1b", b"") + message + bytes([check]), sequence) == body


def line(at: int, kind: int, data: bytes) -> str:
    """Return a record of Intel HEX."""
    record = bytes([len(data), at >> 8, at & 0xFF, kind]) + data
    return f":{record.hex().upper()}{-sum(record) & 0xFF:02X}\n"


A, B, THE_END = line(0, 0, b"A" * 16), line(16, 0, b"B" * 16), line(0, 1, b"")
LAST = line(0, 2, b"\x30\0") + line(0xDFF0, 0, b"Z" * 16)
"""Records of the last 16 bytes of the flash."""


@pytest.mark.parametrize(
    ("text", "length"),
    [
        (A + THE_END, 16),
        ("\ufeff" + A.lower() + "\n \r\n" + THE_END + "\n", 16),
        (A + B + line(0, 3, bytes(4)) + line(0, 5, bytes(4)) + THE_END, 32),
        (A + line(0, 4, b"\0\1") + A + THE_END, 0x10010),
        (A + LAST + THE_END, FLASH),
    ],
)
def test_a_hex_file_is_read(tmp_path: Path, text: str, length: int) -> None:
    path = tmp_path / "some.hex"
    path.write_text(text, encoding="utf-8")
    image = flash.read_hex(path)
    assert len(image) == length
    assert image.startswith(b"A" * 16)
    assert set(image[32:-16]) <= {0xFF}


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "is incomplete"),
        (A + "\n" + B, "is incomplete"),
        (THE_END, "is incomplete"),
        ("hello\n", "line 1 is no record.*begin at 0, rise, and end at 0x3e000: 'hello'"),
        (A + "\n" + B.replace("42", "43", 1) + THE_END, "line 3"),
        (B + THE_END, "line 1"),
        (A + B + line(31, 0, b"AA") + THE_END, "line 3"),
        (A + THE_END + "\n" + B, "line 4"),
        (A + line(0, 9, b"x") + THE_END, "line 2"),
        (A + line(0, 4, bytes([255] * 8)) + B + THE_END, "line 2"),
        (A + line(0, 4, b"\xff\xff") + A + THE_END, "line 3"),
        (A + LAST + line(0xE000, 0, b"Z") + THE_END, "line 4"),
    ],
)
def test_an_invalid_hex_file_is_rejected_with_its_cause(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "some.hex"
    path.write_text(text)
    with pytest.raises(WrongUsage, match=why):
        flash.read_hex(path)
