"""Unmodified programs of 2023 at the port of a node: real terminals and processes."""

from __future__ import annotations

import contextlib
import time
from itertools import groupby
from pathlib import Path

import pytest
from dialogues import DIALOGUES, expected_replies, read
from old_programs import Place, Program
from robots import Stage, until

from beatrix_zenoh import Interrupted, Refused
from beatrix_zenoh.contract._generated.messages import Command, EventKind, Phase, Reason

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


@pytest.mark.bodies("hw")
def test_an_old_program_is_refused_until_no_other_seat_drives(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.until_free()
        place.robot.look(yaw=2)
        assert program.say("@MOVRX 50 200") == ["ACK\n", "NACK\n"]
        assert any("old program: ana drives" in line for line in place.robot.status().warnings)
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        place.until_free()
        program.port.write(b"@MOVRX 100 200\r")
        until(lambda: place.robot.status().moving, "the old program moves")
        with pytest.raises(Refused, match="legacy drives"):
            place.robot.look(yaw=5)
        assert program.read(2) == ["ACK\n", "ACK\n"]
        assert place.robot.status().holder == "legacy"


@pytest.mark.bodies("hw")
def test_an_old_program_cannot_switch_off_a_robot_that_another_seat_drives(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.until_free()
        motion = place.robot.look(yaw=1, speed=2, wait=False)
        assert program.say("@ENMOTORS OFF") == ["ACK\n", "NACK\n"]
        motion.wait()
        assert place.robot.status().calibrated


def test_a_robot_file_with_other_limits_is_refused_with_legacy(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text("[limits]\nyaw_max = 10.0\n", encoding="utf-8")
    with Stage() as stage:
        node = ("--connect", stage.endpoint, "--legacy", str(tmp_path / "COM4"))
        process = stage.process("sim_node", *node, "--robot-file", str(tmp_path / "lab.toml"))
        assert process.wait() == 2
        assert any("--robot-file" in line for line in process.lines)
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


@pytest.mark.long("waits longer than the pause of a stopped program")
@pytest.mark.bodies("hw")
def test_a_program_that_moves_every_second_stays_stopped_until_it_closes_the_port(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(place.turn(600))
        until(place.far, "moving")
        place.robot.stop()
        assert program.read(2) == ["ACK\n", "NACK\n"]
        for _ in range(7):
            time.sleep(0.9)
            assert program.say("@MOVRX 5 200") == ["ACK\n", "NACK\n"]
            assert not place.robot.status().moving
        time.sleep(5.1)
        assert program.say("@MOVRX 5 200") == ["ACK\n", "ACK\n"], "no motion was sent for five seconds"
        place.robot.stop()
    with place.program() as program:
        program.begin()
        assert program.say("@MOVRX 5 200") == ["ACK\n", "ACK\n"], "the next program is not stopped"


@pytest.mark.bodies("hw")
def test_a_refused_program_does_not_take_the_lease(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.robot.emergency_stop()
        for _ in range(3):
            assert program.say("@ENMOTORS ON") == program.say("@MOVRX 50 200") == ["ACK\n", "NACK\n"]
            assert place.robot.status().holder == ""
        place.robot.command(Command.RESET)  # as a user does after checking the robot


def test_stopall_is_carried_out_at_once(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(b"@MOVRALL 600 600 600\r@MOVRX 50 200\r@GETXPOS\r")
        until(place.far, "moving")
        began_s = time.monotonic()
        program.port.write(b"@STOPALL\r")
        assert program.read(4) == ["ACK\n", "NACK\n"] * 2
        assert program.read(3)[::2] == ["ACK\n", "ACK\n"]
        assert program.read(2) == ["ACK\n", "ACK\n"]
        assert time.monotonic() - began_s < 1.0
        assert not place.robot.status().moving
        assert program.say("@MOVRX 5 200") == ["ACK\n", "ACK\n"], "its own STOP does not block it"


def test_a_motion_of_another_seat_is_stopped_by_an_old_program(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.until_free()
        motion = place.robot.look(yaw=60, wait=False)
        assert program.say("@STOPALL") == ["ACK\n", "ACK\n"]
        with pytest.raises(Interrupted) as end:
            motion.wait()
        assert end.value.reason is Reason.STOPPED


def test_after_the_end_of_a_program_its_motion_is_finished_and_waiting_lines_are_dropped(
    place: Place,
) -> None:
    place.until_free()
    place.robot.make_ready()  # else @CALNOW would set home, from which positions count
    at = place.robot.positions().commanded.short
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r@MOVRALL 100 100 100\r@MOVRALL -100 -100 -100\r")
        until(lambda: place.robot.status().moving, "moving")
    until(lambda: not place.robot.status().moving, "it rests")
    assert place.robot.positions().commanded.short == pytest.approx(at + 8.6, abs=0.1), "100 steps"


@pytest.mark.bodies("hw")
def test_a_line_with_words_that_are_no_numbers_is_carried_out_with_a_warning(place: Place) -> None:
    with place.program() as program:
        program.begin()
        since = place.newest_event()
        for line in ("@MOVRX None", "@MOVRALL 5 5"):
            assert program.say(line) == ["ACK\n", "ACK\n"]
        until(lambda: place.events(since)[-1].message.startswith("@MOVRALL"), "the events")
    events = place.events(since)
    warnings = [event.message for event in events if event.kind is EventKind.WARNING]
    assert warnings == [
        "old program: `@MOVRX None`: `None` is no number and counts as 0.",
        "old program: `@MOVRALL 5 5`: 1 of 3 numbers is missing and counted as 0.",
    ]
    begun = [event.message for event in events if event.phase is Phase.ACCEPTED]
    assert begun[0] == "@MOVRX None: `None` is no number and counts as 0."
