"""`beatrix flash` against the boot loader that is on every Arduino Mega: the real one, on the bench."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from avr.bench import Avr
from avr.mega import HEX
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import NoAnswer
from beatrix_zenoh._generated.serial import CONTRACT, FrameType, HelloReply
from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.errors import WrongUsage
from hw_node import flash, hexfile, stk500

LOADER = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders/stk500v2/stk500boot_v2_mega2560.hex")
IMAGE = flash.firmware(None)


class BenchWire:
    """The bench's serial wire, in virtual time; can lose and spoil what the board says."""

    def __init__(self, avr: Avr, spoil: float = 0.0, pull_after: int = 1 << 30) -> None:
        self.avr, self._spoil, self._left = avr, spoil, pull_after
        self._chance = random.Random(1)

    def write(self, data: bytes) -> object:
        self._left -= 1
        if self._left < 0:
            raise OSError("the cable is out")
        self.avr.deliver(data)
        return None

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


def board() -> Avr:
    """A Mega as it is sold: nothing but its boot loader."""
    return Avr(LOADER, baud=stk500.BAUD)


def hello(avr: Avr) -> HelloReply | None:
    """Who answers at the firmware's speed."""
    avr.byte_cycles = 640
    avr.run_ms(1500)
    avr.receive()
    avr.deliver(encode(FrameType.HELLO, 1, b""))
    avr.run_ms(20)
    frames = [frame for frame in Decoder().feed(avr.receive()) if frame.type == FrameType.HELLO_REPLY]
    return HelloReply.unpack(frames[0].payload) if frames else None


def test_a_new_board_is_flashed_verified_and_answers() -> None:
    told: list[tuple[str, int, int]] = []
    with board() as avr:
        flash.program(BenchWire(avr), IMAGE, lambda *news: told.append(news))
        said = hello(avr)
    assert said is not None
    assert said.contract == CONTRACT
    assert told[-1] == ("Verifying", len(IMAGE), len(IMAGE))
    assert [news[0] for news in told] == sorted((news[0] for news in told), reverse=True)


def test_answers_lost_on_the_wire_are_asked_for_again() -> None:
    with board() as avr:
        flash.program(BenchWire(avr, spoil=0.005), IMAGE, lambda *_: None)
        assert hello(avr) is not None


@pytest.mark.parametrize("after", [8, 60, 170])
def test_a_board_left_half_written_is_told_and_does_not_run(after: int) -> None:
    with board() as avr:
        flash.program(BenchWire(avr), IMAGE, lambda *_: None)
        avr.reset()
        avr.byte_cycles = round(160_000_000 / stk500.BAUD)
        with pytest.raises(NoAnswer, match=r"only half of a firmware.*flash` again"):
            flash.program(BenchWire(avr, pull_after=after), IMAGE, lambda *_: None)
        avr.reset()
        assert hello(avr) is None
        assert not avr.enabled
        assert len(avr.edges("step")) == 0
        avr.reset()
        avr.byte_cycles = round(160_000_000 / stk500.BAUD)
        avr.receive()
        flash.program(BenchWire(avr), IMAGE, lambda *_: None)
        assert hello(avr) is not None


def test_a_board_that_answers_something_else_is_not_written_to() -> None:
    with Avr(HEX) as avr, pytest.raises(NoAnswer, match="boot loader does not answer: is it an Arduino Mega"):
        flash.program(BenchWire(avr), IMAGE, lambda *_: None)


@given(noise=st.binary(max_size=40), body=st.binary(min_size=1, max_size=300), sequence=st.integers(0, 255))
def test_an_answer_is_found_in_noise_and_never_in_a_spoilt_one(
    noise: bytes, body: bytes, sequence: int
) -> None:
    message = bytes([0x1B, sequence]) + len(body).to_bytes(2, "big") + b"\x0e" + body
    check = 0
    for byte in message:
        check ^= byte
    assert stk500.find(message + bytes([check]), sequence) == body
    assert stk500.find(message + bytes([check ^ 1]), sequence) is None
    assert stk500.find(noise.replace(b"\x1b", b"") + message + bytes([check]), sequence) == body


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (":0100000041BE\n:00000001FF\n", ""),
        (":0100000041BE\n", "cut off"),
        (":0100000041BF\n:00000001FF\n", "line 1"),
        ("hello\n", "line 1"),
        (":00000001FF\n", "0 bytes"),
    ],
)
def test_a_hex_file_is_read_or_its_wrong_line_named(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "some.hex"
    path.write_text(text)
    if why:
        with pytest.raises(WrongUsage, match=why):
            flash.firmware(path)
    else:
        assert hexfile.read(path) == b"A"
