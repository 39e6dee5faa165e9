"""Unmodified programs of 2023 at the port of a node: real terminals and processes."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import pytest
from dialogues import DIALOGUES, expected_replies, read
from old_programs import Place
from robots import until
from shell import beatrix

from beatrix_zenoh import Refused

SLOW = pytest.mark.long("half a minute in real time; test_text_dialogues.py has it in virtual time")


@pytest.mark.bodies("sim")
@pytest.mark.parametrize(
    "dialogue",
    [
        pytest.param(path, id=path.stem, marks=() if path.stem == "every-reply" else SLOW)
        for path in DIALOGUES
    ],
)
def test_the_recorded_dialogues_are_reproduced_exactly(place: Place, dialogue: Path) -> None:
    entries = read(dialogue)
    replies = iter(expected_replies(entries))
    with place.program() as program:
        for to_robot, group in groupby(entries, key=lambda line: line.to_robot):
            if to_robot:
                for line in group:
                    program.port.write(line.text.encode())
            else:
                due = [next(replies).text for _ in group]
                assert program.read(len(due)) == due


@pytest.mark.long("waits for the end of a lease")
@pytest.mark.bodies("hw")
def test_an_old_program_is_refused_until_no_other_seat_drives(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.until_free()
        place.robot.look(yaw=2)
        assert program.say("@MOVRX 50 200") == ["ACK\n", "NACK\n"]
        assert program.say("@ENMOTORS OFF") == ["ACK\n", "NACK\n"]
        assert place.robot.status().calibrated
        assert any("old program: ana drives" in line for line in place.robot.status().warnings)
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        place.until_free()
        program.port.write(b"@MOVRX 100 200\r")
        until(lambda: place.robot.status().moving, "the old program moves")
        with pytest.raises(Refused, match="legacy drives"):
            place.robot.look(yaw=5)
        assert program.read(2) == ["ACK\n", "ACK\n"]
        assert place.robot.status().holder == "legacy"


def test_a_robot_file_with_other_limits_is_refused_with_legacy(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text("[limits]\nyaw_max = 10.0\n", encoding="utf-8")
    done = beatrix("sim", "--legacy", str(tmp_path / "COM4"), "--robot-file", str(tmp_path / "lab.toml"))
    assert (done.returncode, "--robot-file" in done.stderr) == (2, True)
    assert not (tmp_path / "COM4").is_symlink()


@pytest.mark.bodies("hw")
def test_any_client_stops_an_old_program(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(b"@MOVRALL 600 600 600\r@MOVRX 5 5\r")
        until(place.far, "moving")
        assert "rest at" in place.robot.stop().message
        assert program.read(4) == ["ACK\n", "NACK\n"] * 2
        assert 0 < program.x < 500
        assert program.say("@MOVRX 5 200") == ["ACK\n", "NACK\n"], "a stopped program has to pause"
