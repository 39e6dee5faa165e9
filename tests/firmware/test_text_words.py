"""Lines of text: ends, words, arguments, lengths; and their queue, in which STOPALL takes effect at once."""

from __future__ import annotations

import re

import pytest
from firmware_host import ROOT, Steps
from hypothesis import given
from hypothesis import strategies as st
from text_port_programs import ACK, DONE, NACK, REFUSED, UNKNOWN, Program

from beatrix_zenoh.contract._generated.serial import BoardOutcome, BoardState

SOURCE = "firmware/beatrix/src/core/text_command.cpp"
LONG = 400
"""Milliseconds, enough for every motion here."""


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n", b"\n\r", b"\r\r\n\n"])
def test_cr_lf_and_crlf_each_end_a_line_once(program: Program, end: bytes) -> None:
    program.send(b"@COMSTATUS" + end + b"@CALSTATUS" + end)
    assert program.new() == DONE * 2


@pytest.mark.parametrize(
    "line", ["@FOO", "@", "@ ", "@enmotors ON", "@ENMOTOR", "@ENMOTORSS ON", "@@COMSTATUS"]
)
def test_an_unknown_word_is_answered_once(program: Program, line: str) -> None:
    assert program.say(line) == UNKNOWN


def test_the_guide_lists_every_word() -> None:
    guide = (ROOT / "docs/how-to/old-programs.md").read_text(encoding="utf-8")
    words = re.findall(r'{"@(\w+)"', (ROOT / SOURCE).read_text(encoding="utf-8"))
    assert len(words) == 25
    assert [word for word in words if not re.search(rf"`@{word}\b", guide)] == []


@pytest.mark.parametrize("argument", ["32768", "-32768", "65537", "99999999999999999"])
@pytest.mark.parametrize(
    "form",
    [
        "@MOVRX {}",
        "@MOVAZ {} 200",
        "@MOVRALL 1 2 {}",
        "@MOVAALL {} 0 0",
        "@MOVTORPOS {} 0",
        "@MOVTOAPOS 0 {}",
    ],
)
def test_numbers_beyond_32767_are_refused_and_move_nothing(
    program: Program, form: str, argument: str
) -> None:
    assert program.say(form.format(argument)) == REFUSED
    program.tick(LONG)
    assert program.position == (0, 0, 0)


@pytest.mark.parametrize(
    ("line", "moved"),
    [
        ("@MOVRX  7 200", (0, 0, 0)),
        ("@MOVRX 7", (7, 0, 0)),
        ("@MOVRX 7 200 ", (7, 0, 0)),
        ("@MOVRZ -7 99999", (0, 0, -7)),
        ("@MOVRX 7 abc def", (7, 0, 0)),
        ("@MOVRALL 1 2 3", (1, 2, 3)),
        ("@MOVRALL 1 2 3 200", (1, 2, 3)),
        ("@MOVRALL 1 2 3 200 200 200", (1, 2, 3)),
        ("@MOVRALL 1 2 3 0 200 200 200 0", (1, 2, 3)),
        ("@MOVRALL 1 2 3 99999 99999 99999 99999", (1, 2, 3)),
        ("@MOVRALL 1", (1, 0, 0)),
        ("@MOVRALL 1  3", (1, 0, 3)),
        ("@MOVAALL 4 5 6 7 8 9", (4, 5, 6)),
        ("@MOVAY 9 1", (0, 9, 0)),
        ("@MOVTORPOS 10 30 200", (40, -10, 0)),
        ("@MOVTOAPOS 10 -4 200", (6, 12, 11)),
    ],
)
def test_extra_and_missing_arguments_are_accepted(program: Program, line: str, moved: Steps) -> None:
    assert program.run(line) == DONE
    assert program.position == moved


@given(st.binary(max_size=200).map(lambda data: data.translate(None, b"\0\r\n")))
def test_any_line_is_answered_at_least_once(line: bytes) -> None:
    program = Program()
    program.send(b"@" + line + b"\r")
    program.tick(5)
    assert len(program.new()) >= 1
    assert program.say("@COMSTATUS")[-2:] == DONE


# -- the queue --------------------------------------------------------------------------------------


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
