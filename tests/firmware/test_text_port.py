"""Zero and calibration of the text port, which do not depend on home."""

from __future__ import annotations

import pytest
from text_port_programs import Program

from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    BoardState,
    FrameType,
    MoveStraight,
    WarningCode,
)

ACK, NACK = "ACK\n", "NACK\n"
DONE, REFUSED = [ACK, ACK], [ACK, NACK]
TO_ORIGIN = MoveStraight(7, (0, 0, 0), 4000).pack()


@pytest.fixture
def program() -> Program:
    return Program().ready()


@pytest.fixture
def framed() -> Program:
    return Program(framed=True)


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
    framed.ready()
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
    framed.ready()
    framed.frame(FrameType.MOVE_STRAIGHT, MoveStraight(7, (500, 500, 500), 2000).pack())
    framed.tick(300)
    assert framed.telemetry[-1].motion == 7
    assert framed.run("@MOVHOME") == DONE
    assert framed.core.steps() == (0, 0, 0)
    framed.tick(200)
    assert (framed.telemetry[-1].motion, framed.telemetry[-1].outcome) == (0, BoardOutcome.DONE)


def test_stopall_stops_a_motion_of_the_host(framed: Program) -> None:
    framed.ready()
    framed.frame(FrameType.MOVE_STRAIGHT, MoveStraight(7, (500, 500, 500), 800).pack())
    framed.tick(500)
    assert framed.say("@STOPALL") == [ACK]
    framed.tick(150)
    assert framed.new() == [ACK]
    assert (framed.telemetry[-1].motion, framed.telemetry[-1].outcome) == (7, BoardOutcome.STOPPED)


def test_opening_the_port_resets_everything_except_home(framed: Program) -> None:
    framed.ready().run("@MOVRALL 100 100 100")
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
