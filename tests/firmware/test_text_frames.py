"""The board sends frames to hosts, plain text to old programs, and nothing without input."""

from __future__ import annotations

import random

import pytest
from firmware_host import Rig
from text_port_programs import Program

from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    HOST_GONE,
    TELEMETRY_SIZE,
    Enable,
    Error,
    FrameType,
    MoveStraight,
    Telemetry,
    TextWarning,
    WarningCode,
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
        encode(FrameType.TELEMETRY, 1, bytes(TELEMETRY_SIZE)),
        b"@PING\r",
        b"\0\0\0",
    ],
)
def test_only_a_valid_request_counts_as_a_host(data: bytes) -> None:
    firmware = Firmware()
    firmware.receive(data)
    firmware.tick(100)
    assert firmware.transmit() in (b"", b"NACK\n")


def test_replies_are_plain_after_the_host_timeout() -> None:
    firmware = Firmware()
    firmware.receive(PING)
    firmware.tick(HOST_GONE - 1)
    firmware.transmit()
    firmware.receive(b"@COMSTATUS\r")
    assert b"\0" in firmware.transmit()
    firmware.tick(1)
    firmware.receive(b"@COMSTATUS\r")
    assert firmware.transmit() == b"ACK\nACK\n"


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


def test_without_a_host_a_text_motion_needs_no_heartbeat() -> None:
    program = Program().ready()
    assert program.run("@MOVRALL 1000 1000 1000") == DONE
    assert program.core.steps() == (1000, 1000, 1000)


def test_text_between_frames_and_frames_between_lines_are_answered() -> None:
    program = Program(framed=True)
    program.send(PING + b"@ENMOTORS ON\r" + PING + b"@CALNOW\r\n" + PING + b"\r\n@GETXPOS\n\n" + PING)
    program.tick(3)
    assert program.new() == [*DONE, *DONE, ACK, "0\r\n", ACK]
    assert len(program.others) == 5


@pytest.mark.parametrize("cut", range(1, 14))
def test_a_frame_inside_a_line_discards_the_line_and_is_executed(cut: int) -> None:
    program = Program(framed=True)
    line = b"@COMSTATUS   \r"
    program.send(line[:cut] + encode(FrameType.PING, 9, b""))
    assert (program.others[-1].type, program.others[-1].seq) == (FrameType.PING | 0x80, 9)
    assert program.new() == []
    assert program.say("@COMSTATUS") == DONE


def test_lines_inside_frames_are_ignored() -> None:
    rig = Rig()
    for text in (b"\r@STOPALL\r", b"@STOPALL\r\n@CALNOW\r"):
        (reply,) = rig.raw(encode(FrameType.SET_NAME, 1, text.ljust(32, b"\r")))
        assert reply.payload == bytes([Error.BAD_VALUE])
    assert rig.raw(encode(0x3E, 1, b"\n@COMSTATUS\r" * 4))[0].payload == bytes([Error.UNKNOWN])


def test_noise_that_looks_like_a_frame_blocks_text_for_at_most_two_seconds() -> None:
    program = Program()
    program.send(b"\0" + b"\x05noise")
    for _ in range(20):
        program.send(b"@COMSTATUS\r")
        program.tick(100)
    assert len(program.new()) >= 2 * 13  # answered once the noise is longer than a frame
    program.send(b"\0" + b"\x05noise")
    program.tick(2001)
    assert program.say("@COMSTATUS") == DONE


def test_an_abandoned_frame_is_counted_once() -> None:
    rig = Rig()
    rig.raw(b"\0\x05\x02")
    rig.tick(2500)
    rig.raw(PING)
    rig.tick(10)
    assert rig.last.rejected == 1


def test_text_and_warning_frames_share_one_sequence_number() -> None:
    firmware = Firmware()
    firmware.receive(PING + b"@CALNOW\r@MOVRX 1\r")
    firmware.tick(100)
    frames = [frame for frame in Decoder().feed(firmware.transmit()) if frame.type > FrameType.TELEMETRY]
    assert [frame.seq for frame in frames] == list(range(5))
    warnings = [frame for frame in frames if frame.type == FrameType.TEXT_WARNING]
    assert [TextWarning.unpack(frame.payload).code for frame in warnings] == [WarningCode.MOTORS_OFF]


def test_text_leaves_room_for_a_reply_and_continues_later() -> None:
    firmware = Firmware()
    line = b"@GETALLPOS\r" * 15  # the receive buffer takes 191 bytes at once
    firmware._memory.write(firmware._store, line, firmware._receive_at)
    for _ in range(100):  # without emptying the transmit buffer
        assert firmware._call("receive", len(line)) == len(line)
    hello = encode(FrameType.HELLO, 1, b"")
    firmware._memory.write(firmware._store, hello, firmware._receive_at)
    assert firmware._call("receive", len(hello)) == len(hello)
    sent = firmware.transmit()
    assert Decoder().feed(sent)[-1].type == FrameType.HELLO_REPLY
    answer = b"ACK\n\n0 0 0\nACK\n"
    assert sent.startswith(answer * 900)
    firmware.tick(1)
    assert b"0 0 0\n" in firmware.transmit()


@pytest.mark.parametrize("seed", range(20))
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


@pytest.mark.parametrize("seed", range(10))
def test_every_line_of_a_random_program_is_answered(seed: int) -> None:
    chance = random.Random(seed)
    program = Program(framed=bool(seed % 2))
    words = ["@COMSTATUS", "@CALX", "@STOPALL", "@CALNOW", "@ENMOTORS ON", "@MOVHOME", "@FOO"]
    words += ["@MOVRX 20", "@MOVRALL 5 -60 7", "@MOVAY -40"] * 3
    lines = [chance.choice(words) for _ in range(400)]
    for line in lines:
        program.send(line.encode("ascii") + chance.choice([b"\r", b"\n", b"\r\n"]))
        program.tick(chance.choice([0, 0, 3, 200]))
    program.tick(20_000)
    assert len(program.lines) == 2 * len(lines) - lines.count("@FOO")
