"""Programs of 2023, unmodified, at the port a node opens for them: real terminals, real processes."""

from __future__ import annotations

import contextlib
import time
from itertools import groupby
from pathlib import Path

import pytest
from dialogue import DIALOGUES, read, wanted
from old_program import Place, Program
from stage import Stage, until, wait_status

from beatrix_zenoh import Interrupted, Refused
from beatrix_zenoh._generated.messages import Reason


@pytest.mark.parametrize("dialogue", DIALOGUES, ids=lambda path: path.stem)
def test_a_dialogue_is_spoken_word_for_word(place: Place, dialogue: Path) -> None:
    said = read(dialogue)
    replies = iter(wanted(said))
    with place.program() as program:
        for asked, group in groupby(said, key=lambda line: line.to_robot):
            if asked:
                for line in group:
                    program.port.write(line.text.encode())
            else:
                due = [next(replies).text for _ in group]
                assert program.read(len(due)) == due


def test_every_opening_is_a_power_up(place: Place) -> None:
    with place.program() as program:
        program.begin()
        assert program.say("@MOVRX 20 200") == ["ACK\n", "ACK\n"]
        assert program.x == 20
    with place.program() as program:
        assert program.say("@CALSTATUS") == ["ACK\n", "NACK\n"]
        assert program.x == 0
        assert program.say("@MOVRX 20 200") == ["ACK\n", "NACK\n"]
        wait_status(
            place.robot, lambda status: "@CALNOW must come before it" in " ".join(status.warnings), "told"
        )


def test_line_ends_and_what_is_no_line(place: Place) -> None:
    with place.program() as program:
        program.port.write(b"@COMSTATUS\r\n\n\r@COMSTATUS\n")
        assert program.read(4) == ["ACK\n"] * 4
        for unknown in (b"hello", b"@" + b"x" * 300, "@MOVRÄ 1 2".encode(), b"@MOV\x00RX 1 2"):
            program.port.write(unknown + b"\r")
            assert program.read(1) == ["NACK\n"], unknown
        program.port.write(b"ACK\rNACK\r")  # as a terminal that echoes sends our own answers back
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        program.port.write(b"@COM")
        time.sleep(2.3)  # the line is forgotten
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]


def test_who_drives_is_asked_first_and_an_old_program_drives_like_any_other(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.robot.look(yaw=2)
        assert program.say("@MOVRX 50 200") == ["ACK\n", "NACK\n"]
        assert any("old program: ana drives" in line for line in place.robot.status().warnings)
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        until(lambda: place.robot.status().holder == "", "the lease is over", 4.0)
        program.port.write(b"@MOVRX 100 200\r")
        until(lambda: place.robot.status().moving, "the old program moves")
        with pytest.raises(Refused, match="legacy drives"):
            place.robot.look(yaw=5)
        assert program.read(2) == ["ACK\n", "ACK\n"]
        assert place.robot.status().holder == "legacy"


def test_an_old_program_does_not_switch_a_robot_that_somebody_drives(place: Place) -> None:
    with place.program() as program:
        program.begin()
        motion = place.robot.look(yaw=3, speed=2, wait=False)
        for line in ("@ENMOTORS OFF", "@CALNOW"):
            assert program.say(line) == ["ACK\n", "NACK\n"], line
        motion.wait()
        assert place.robot.status().calibrated


def test_a_program_that_asks_without_end_holds_up_nobodys_motion(place: Place) -> None:
    """Its lines are no heartbeat: the node must go on with its own."""
    with place.program() as program:
        program.begin()
        motion = place.robot.look(yaw=40, wait=False)
        while motion.poll(0.0) is None:
            assert program.say("@GETXPOS", 3)[::2] == ["ACK\n", "ACK\n"]
        motion.wait()


def test_limits_of_a_lab_that_old_programs_could_not_keep_are_refused(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text("[limits]\nyaw_max = 10.0\n", encoding="utf-8")
    with Stage() as stage:
        node = ("--connect", stage.endpoint, "--legacy", str(tmp_path / "COM4"))
        process = stage.process("sim_node", *node, "--robot-file", str(tmp_path / "lab.toml"))
        assert process.wait(20) == 2
        assert any("do not go together" in line for line in process.lines)
    assert not (tmp_path / "COM4").is_symlink()


def test_the_next_program_gets_no_answer_of_the_one_before(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r@MOVRALL 100 100 100\r")
        until(lambda: place.robot.status().moving, "moving")
    with place.program() as program:
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        until(lambda: not place.robot.status().moving, "it rests")
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]


def test_a_motion_with_motors_off_takes_its_time(place: Place) -> None:
    with place.program() as program:
        place.robot.disable()
        assert program.say("@ENMOTORS OFF") == program.say("@CALNOW") == ["ACK\n", "ACK\n"]
        program.port.write(b"@MOVRX 900 200\r")
        assert program.read(2) == ["ACK\n", "ACK\n"]
        assert program.x == 900, "only counted"


def test_anybody_stops_an_old_program(place: Place) -> None:
    with place.program() as program:
        program.begin()
        program.port.write(b"@MOVRALL 600 600 600\r@MOVRX 5 5\r")
        until(place.far, "moving")
        assert "rest at" in place.robot.stop().message
        assert program.read(4) == ["ACK\n", "NACK\n"] * 2
        assert 0 < program.x < 500
        assert program.say("@MOVRX 5 200") == ["ACK\n", "NACK\n"], "who was stopped has to pause"
        time.sleep(1.1)
        assert program.say("@MOVRX 5 200") == ["ACK\n", "ACK\n"], "it may again"


def test_a_program_that_is_refused_again_and_again_does_not_drive(place: Place) -> None:
    with place.program() as program:
        program.begin()
        place.robot.emergency_stop()
        for _ in range(3):
            assert program.say("@ENMOTORS ON") == program.say("@MOVRX 50 200") == ["ACK\n", "NACK\n"]
            assert place.robot.status().holder == ""
        place.robot.enable()  # as a person who has looked does


def test_its_own_stop_acts_at_once(place: Place) -> None:
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
        assert program.say("@MOVRX 5 200") == ["ACK\n", "ACK\n"], "who presses STOP knows"


def test_a_motion_of_somebody_else_is_stopped_by_an_old_program(place: Place) -> None:
    with place.program() as program:
        program.begin()
        motion = place.robot.look(yaw=60, wait=False)
        assert program.say("@STOPALL") == ["ACK\n", "ACK\n"]
        with pytest.raises(Interrupted) as end:
            motion.wait()
        assert end.value.reason is Reason.STOPPED


def test_what_is_under_way_when_the_program_ends_is_finished_what_waits_is_not_begun(place: Place) -> None:
    until(lambda: place.robot.status().holder == "", "free", 5.0)
    at = place.robot.positions().commanded.short
    with contextlib.closing(Program(place.path).port) as port:
        port.write(b"@ENMOTORS ON\r@CALNOW\r@MOVRALL 100 100 100\r@MOVRALL -100 -100 -100\r")
        until(lambda: place.robot.status().moving, "moving")
    until(lambda: not place.robot.status().moving, "it rests")
    assert place.robot.positions().commanded.short == pytest.approx(at + 8.6, abs=0.1), "100 steps"
    until(lambda: place.robot.status().holder == "", "free", 3.0)


def test_moves_faster_than_they_can_be_made_are_all_answered_in_turn(place: Place) -> None:
    """Thirty of these at this pace drove firmware 1.0 wild."""
    count = 50
    with place.program() as program:
        program.begin()
        for number in range(count):
            x = 40 if number % 2 else -40
            program.port.write(f"@MOVAALL {x} 0 {-x} 220 220 220\r".encode())
            time.sleep(0.15 if number < 15 else 0.0)
        until(lambda: "too many are waiting" in " ".join(place.robot.status().warnings), "a warning")
        replies = program.read(2 * count)
        assert replies[0::2] == ["ACK\n"] * count
        busy = replies[1::2].count("NACK\n")
        assert replies[1::2].count("ACK\n") == count - busy
        assert 0 < busy < count - 32
        assert program.say("@COMSTATUS") == ["ACK\n", "ACK\n"]
        assert abs(program.x) == 40


def test_limits_shorten_a_motion_and_say_so(place: Place) -> None:
    with place.program() as program:
        program.begin()
        assert program.say("@MOVRALL 500 0 -500") == ["ACK\n", "ACK\n"]
        assert 0 < program.x < 500
        warnings = place.robot.status().warnings
        assert "shortened" in warnings[-1]
        assert sum("shortened" in warning for warning in warnings) == 1
        tilt = place.robot.positions().head
        assert abs(tilt.pitch) < 36
