"""Lines of text: ends, words, arguments, lengths."""

from __future__ import annotations

import re

import pytest
from firmware_host import ROOT, Steps
from hypothesis import given
from hypothesis import strategies as st
from text_port_programs import Program

ACK, NACK = "ACK\n", "NACK\n"
DONE, REFUSED, UNKNOWN = [ACK, ACK], [ACK, NACK], [NACK]
SOURCE = "firmware/beatrix/src/core/text_command.cpp"
LONG = 400
"""Milliseconds, enough for every motion here."""


@pytest.fixture
def program() -> Program:
    return Program().ready()


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
