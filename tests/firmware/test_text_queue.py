"""Queue of text commands: every line is answered, replies keep their order, and STOPALL takes effect at once."""

from __future__ import annotations

import pytest
from text_port_programs import Program

from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState

ACK, NACK = "ACK\n", "NACK\n"
DONE, REFUSED, UNKNOWN = [ACK, ACK], [ACK, NACK], [NACK]


@pytest.fixture
def program() -> Program:
    return Program().ready()


@pytest.fixture
def framed() -> Program:
    return Program(framed=True).ready()


def test_every_line_of_a_flood_on_a_full_queue_is_answered(program: Program) -> None:
    program.send(b"@MOVRX 100\r" + b"@MOVRX 1\r" * 32)
    for _ in range(50):
        program.send(b"@GETXPOS\r" * 200)
    program.send(b"@FOO\r" * 200)
    program.tick(10_000)
    assert program.new() == DONE * 33 + REFUSED * 10_000 + UNKNOWN * 200


def test_stopall_stops_at_once(framed: Program) -> None:
    framed.send(b"@MOVRX 1000\r")
    framed.tick(1000)
    assert framed.new() == [ACK]
    at = framed.core.steps()[0]
    framed.send(b"@STOPALL\r")
    framed.tick(1)
    assert BoardState(framed.telemetry[-1].state) & BoardState.STOPPING
    framed.tick(150)
    assert framed.new() == [NACK, *DONE]
    assert framed.core.steps()[0] - at <= 12
    assert framed.telemetry[-1].outcome == BoardOutcome.STOPPED


@pytest.mark.parametrize("ms", [0, 1, 30, 100, 250, 480])
def test_stopall_at_any_time_leaves_two_replies_for_each_line(program: Program, ms: int) -> None:
    program.send(b"@MOVRALL 40 -20 9\r")
    program.tick(ms)
    program.send(b"@STOPALL\r@STOPALL\r")
    program.tick(200)
    answers = program.new()
    assert answers in (REFUSED + DONE * 2, DONE * 3)
    assert answers == REFUSED + DONE * 2 or program.position == (40, -20, 9)


def test_stopall_cancels_motions_when_every_queue_slot_is_used(program: Program) -> None:
    program.send(b"@MOVRX 1000\r" + b"@MOVRX 10\r" * 32 + b"@FOO\r@CALX\r" * 40)
    program.tick(500)
    program.send(b"@STOPALL\r")
    program.tick(110)
    answers = program.new()
    assert answers[: 2 + 32 * 2] == REFUSED * 33
    assert len(answers) >= 33 * 2 + 40 * 3 - 40
    assert program.say("@COMSTATUS") == DONE
