"""The text port beside frames of a host: zero and calibration do not depend on home, and the host may end a motion."""

from __future__ import annotations

import random

import pytest
from text_port_programs import ACK, DONE, NACK, REFUSED, Program

from beatrix_zenoh.board.link import Decoder, encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    HOST_GONE,
    BoardOutcome,
    BoardState,
    Enable,
    FrameType,
    MoveStraight,
    Telemetry,
    WarningCode,
)

TO_ORIGIN = MoveStraight(7, (0, 0, 0), 4000).pack()


def state(program: Program) -> BoardState:
    program.tick(11)
    return BoardState(program.telemetry[-1].state)


def test_calnow_makes_the_present_position_0_without_motion(program: Program) -> None:
    program.run("@MOVRALL 10 20 30")
    assert program.say("@CALNOW", "@CALSTATUS") == DONE * 2
    assert program.position == (0, 0, 0)
    assert program.core.steps() == (10, 20, 30)
    assert program.run("@MOVAX -4") == DONE
    assert program.core.steps() == (6, 20, 30)
    assert program.run("@MOVHOME") == DONE
    assert program.core.steps() == (10, 20, 30)


def test_with_motors_off_moves_are_only_counted() -> None:
    firmware = Firmware()
    framed = Program(firmware, framed=True, look_ms=1)
    framed.say("@CALNOW")
    begin = framed.ms
    assert framed.run("@MOVRX 100 200") == DONE
    assert 0.5 <= (framed.ms - begin) / 1000 <= 0.62
    assert framed.run("@MOVAALL 50 -7 3") == DONE
    assert framed.run("@MOVAZ 4") == DONE
    assert framed.position == (50, -7, 4)
    assert firmware.steps() == (0, 0, 0)
    assert firmware.pulses() == (0, 0, 0)
    assert set(framed.warnings) == {WarningCode.MOTORS_OFF}


def test_text_cannot_clear_an_emergency(framed: Program) -> None:
    framed.frame(FrameType.EMERGENCY_STOP)
    assert framed.say("@MOVRX 10", "@ENMOTORS ON", "@CALNOW", "@MOVRX 10") == REFUSED * 2 + DONE + REFUSED
    assert set(framed.warnings) == {WarningCode.EMERGENCY}
    assert state(framed) == BoardState.EMERGENCY
    framed.frame(FrameType.RESET)
    assert framed.say("@ENMOTORS ON", "@CALNOW") == DONE * 2
    assert framed.run("@MOVRX 10") == DONE


MOVE_ELSEWHERE = (FrameType.MOVE_STRAIGHT, TO_ORIGIN)
STOP = (FrameType.STOP, b"")
EMERGENCY = (FrameType.EMERGENCY_STOP, b"")
OFF = (FrameType.ENABLE, b"\0")


@pytest.mark.parametrize("frame", [MOVE_ELSEWHERE, STOP, EMERGENCY, OFF], ids=lambda frame: frame[0].name)
@pytest.mark.parametrize("motors", ["ON", "OFF"])
def test_a_frame_that_ends_a_text_move_refuses_it_and_cancels_the_queued_ones(
    frame: tuple[FrameType, bytes], motors: str
) -> None:
    framed = Program(framed=True)
    framed.say("@ENMOTORS ON", "@CALNOW", f"@ENMOTORS {motors}", "@CALNOW")
    framed.send(b"@MOVRALL 300 300 300\r@MOVRX 5\r@CALSTATUS\r")
    framed.tick(500)
    assert framed.new() == [ACK]
    framed.frame(*frame)
    framed.tick(3000)
    if motors == "OFF" and frame == MOVE_ELSEWHERE:
        assert framed.new() == [ACK, *DONE, *DONE]  # refused: motors are off; the queue is unchanged
        return
    assert framed.new() == [NACK, *REFUSED, *DONE]
    if frame == MOVE_ELSEWHERE:
        assert framed.core.steps() == (0, 0, 0)
        assert (framed.telemetry[-1].motion, framed.telemetry[-1].outcome) == (7, BoardOutcome.DONE)


def test_a_text_move_replaces_the_motion_of_the_host_under_its_own_number(framed: Program) -> None:
    framed.frame(FrameType.MOVE_STRAIGHT, MoveStraight(7, (500, 500, 500), 2000).pack())
    framed.tick(300)
    assert framed.telemetry[-1].motion == 7
    assert framed.run("@MOVHOME") == DONE
    assert framed.core.steps() == (0, 0, 0)
    framed.tick(200)
    assert (framed.telemetry[-1].motion, framed.telemetry[-1].outcome) == (0, BoardOutcome.DONE)


def test_stopall_stops_a_motion_of_the_host(framed: Program) -> None:
    framed.frame(FrameType.MOVE_STRAIGHT, MoveStraight(7, (500, 500, 500), 800).pack())
    framed.tick(500)
    assert framed.say("@STOPALL") == [ACK]
    framed.tick(150)
    assert framed.new() == [ACK]
    assert (framed.telemetry[-1].motion, framed.telemetry[-1].outcome) == (7, BoardOutcome.STOPPED)


def test_opening_the_port_resets_everything_except_home(framed: Program) -> None:
    framed.run("@MOVRALL 100 100 100")
    framed.send(b"@MOVRALL 300 300 300\r@MOVRX 5\r@GETXPOS\r")
    framed.tick(500)
    framed.send(b"@CALST")
    framed.frame(FrameType.TEXT_OPEN)
    assert [frame.payload for frame in framed.others if frame.type == FrameType.TEXT_OPEN | 0x80] == [b"\0"]
    framed.new()
    framed.tick(500)
    assert framed.new() == []
    assert state(framed) == BoardState.ENABLED | BoardState.CALIBRATED
    assert framed.telemetry[-1].outcome == BoardOutcome.STOPPED
    assert framed.say("@CALSTATUS", "@MOVRX 1") == REFUSED * 2
    assert max(framed.position) < 15
    assert framed.core.steps()[0] > 150


def test_at_power_up_motors_are_off_and_home_is_unknown() -> None:
    program = Program()
    assert program.say("@CALSTATUS", "@MOVRX 1 1", "@MOVHOME") == REFUSED * 3
    assert program.position == (0, 0, 0)


# -- frames to hosts, plain text to old programs, nothing without input ----------------------------

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


def test_losing_the_host_stops_the_text_motion_and_cancels_the_queued_ones(framed: Program) -> None:
    framed.send(b"@MOVRALL 600 600 600\r@MOVRX 50\r@CALNOW\r@MOVRX 50\r")
    framed.framed = False
    framed.core.tick(450)
    assert framed.core.steps()[0] > 50
    framed.core.tick(HOST_GONE)
    at = framed.core.steps()
    assert at[0] < 150
    framed.core.tick(5000)
    assert framed.core.steps() == at
    assert framed.core.transmit()[-20:].count(b"\0") > 0  # the last bytes were frames


@pytest.mark.parametrize("seed", range(5))
def test_after_any_input_known_lines_and_frames_are_answered(framed: Program, seed: int) -> None:
    """Each random input ends with a delimiter, so the next line is complete."""
    chance = random.Random(seed)
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
        framed.send(noise + b"\0")
        framed.tick(chance.choice([0, 1, 50, 300]))
    framed.send(b"\0@STOPALL\r")
    framed.tick(2000)
    framed.new()
    for word in ("@COMSTATUS", "@CALNOW", "@STOPALL", "@GETXPOS"):
        answer = framed.say(word)
        assert (answer[0], answer[-1]) == (ACK, ACK)
        assert len(answer) == (3 if word == "@GETXPOS" else 2)
    framed.others.clear()
    framed.send(PING)
    assert [(reply.type, reply.payload) for reply in framed.others] == [(FrameType.PING | 0x80, b"\0")]
