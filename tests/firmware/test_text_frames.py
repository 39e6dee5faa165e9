"""The board sends frames to hosts, plain text to old programs, and nothing without input."""

from __future__ import annotations

import random

import pytest
from text_port_programs import Program

from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    HOST_GONE,
    Enable,
    FrameType,
    MoveStraight,
    Telemetry,
)

ACK, NACK = "ACK\n", "NACK\n"
DONE, REFUSED = [ACK, ACK], [ACK, NACK]
PING = encode(FrameType.PING, 1, b"")


def test_telemetry_ends_two_seconds_after_the_last_frame_of_the_host() -> None:
    firmware = Firmware()
    firmware.tick(500)
    firmware.receive(PING)
    firmware.tick(5000)
    frames = Decoder().feed(firmware.transmit())
    ticks = [Telemetry.unpack(frame.payload).tick for frame in frames if frame.type == FrameType.TELEMETRY]
    assert ticks[0] == 500
    assert 500 + HOST_GONE - 10 <= ticks[-1] < 500 + HOST_GONE
    firmware.receive(PING)
    assert len(Decoder().feed(firmware.transmit())) == 2


@pytest.mark.parametrize(
    "data",
    [
        b"\0\x05\x02\xff\x70\xcd\0",
        encode(FrameType.TELEMETRY, 1, bytes(Telemetry.layout.size)),
        b"@PING\r",
        b"\0\0\0",
    ],
)
def test_only_a_valid_request_counts_as_a_host(data: bytes) -> None:
    firmware = Firmware()
    firmware.receive(data)
    firmware.tick(100)
    assert firmware.transmit() in (b"", b"NACK\n")


def test_losing_the_host_stops_the_text_motion_and_cancels_the_queued_ones() -> None:
    program = Program(framed=True).ready()
    program.send(b"@MOVRALL 600 600 600\r@MOVRX 50\r@CALNOW\r@MOVRX 50\r")
    program.framed = False
    program.core.tick(450)
    assert program.core.steps()[0] > 50
    program.core.tick(HOST_GONE)
    at = program.core.steps()
    assert at[0] < 150
    program.core.tick(5000)
    assert program.core.steps() == at
    assert program.core.transmit()[-20:].count(b"\0") > 0  # the last bytes were frames


@pytest.mark.parametrize("seed", range(5))
def test_after_any_input_known_lines_and_frames_are_answered(seed: int) -> None:
    """Each random input ends with a delimiter, so the next line is complete."""
    chance = random.Random(seed)
    program = Program(framed=True).ready()
    for _ in range(150):
        noise = chance.choice(
            [
                chance.randbytes(chance.randint(0, 90)),
                b"@" + chance.randbytes(20),
                b"@MOVRALL " + chance.randbytes(5) + b"\r",
                encode(FrameType.STOP, 1, b""),
                encode(FrameType.ENABLE, 1, Enable(chance.randint(0, 1)).pack()),
                encode(
                    FrameType.MOVE_STRAIGHT, 1, MoveStraight(5, (chance.randint(-300, 300), 0, 0), 900).pack()
                ),
                b"@MOVRX %d\r" % chance.randint(-300, 300),
                b"@STOPALL\r",
                b"@CALNOW\r",
                b"",
            ]
        )
        program.send(noise + b"\0")
        program.tick(chance.choice([0, 1, 50, 300]))
    program.send(b"\0@STOPALL\r")
    program.tick(2000)
    program.new()
    for word in ("@COMSTATUS", "@CALNOW", "@STOPALL", "@GETXPOS"):
        answer = program.say(word)
        assert (answer[0], answer[-1]) == (ACK, ACK)
        assert len(answer) == (3 if word == "@GETXPOS" else 2)
    program.others.clear()
    program.send(PING)
    assert [(reply.type, reply.payload) for reply in program.others] == [(FrameType.PING | 0x80, b"\0")]
