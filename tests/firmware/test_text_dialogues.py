"""Replies have the text of the reference dialogues of firmware 1.0, and are never later."""

from __future__ import annotations

from pathlib import Path

import pytest
from dialogues import DIALOGUES, Entry, expected_replies, read
from firmware_host import Core
from text_port_programs import BYTE_MS, DONE, LAST, Program


def played(dialogue: list[Entry], program: Program) -> list[Entry]:
    """Return our replies, with the timing of 9600 baud."""
    for entry in dialogue:
        if entry.to_robot:
            program.tick(entry.ms - program.ms)
            for sent, byte in enumerate(entry.text.encode("ascii")):
                program.tick(int(entry.ms + (sent + 1) * BYTE_MS) + 1 - program.ms)
                program.send(bytes([byte]))
    program.tick(5000)
    free, replies = 0.0, []
    for ms, line in program.lines:
        free = max(free, ms) + len(line) * BYTE_MS
        replies.append(Entry(to_robot=False, ms=int(free), text=line))
    return replies


@pytest.mark.parametrize("framed", [False, True], ids=["direct", "framed"])
@pytest.mark.parametrize("path", DIALOGUES, ids=lambda path: path.stem)
def test_replies_equal_the_reference_dialogue_and_are_not_later(path: Path, framed: bool, body: Core) -> None:
    dialogue = read(path)
    assert len(dialogue) == {"every-move": 47, "every-reply": 57}[path.stem]
    program = Program(body, framed=framed, look_ms=1)
    theirs, ours = expected_replies(dialogue), played(dialogue, program)
    assert [entry.text for entry in ours] == [entry.text for entry in theirs]
    late = [(own, old.ms) for own, old in zip(ours, theirs, strict=True) if own.ms > old.ms]
    assert late == []


def test_flags_mark_the_last_line_of_an_answer(framed: Program) -> None:
    framed.flags.clear()
    framed.say("@GETALLPOS", "@GETXPOS", "@COMSTATUS", "@FOO")
    assert framed.flags == [0, 0, 0, LAST, 0, 0, LAST, 0, LAST, LAST]


@pytest.mark.parametrize(
    ("steps", "seconds"),
    [(1, 0.005), (2, 0.068), (7, 0.239), (100, 1.219), (300, 2.38)],
)
@pytest.mark.parametrize("command", ["@MOVRX", "@MOVAX"])
def test_a_move_of_one_arm_takes_no_longer_than_in_1_0(command: str, steps: int, seconds: float) -> None:
    program = Program(look_ms=1).ready()
    begin = program.ms
    assert program.run(f"{command} {steps} 200") == DONE
    assert (program.ms - begin) / 1000 <= seconds
    assert program.position == (steps, 0, 0)
