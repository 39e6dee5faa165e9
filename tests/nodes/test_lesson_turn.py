"""`beatrix lesson turn`: a program that passed runs on the robot, and every way in which a turn ends."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from robots import until
from shell import CLI, NAME, Shell, wait_until_free

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.lessons import program, progress, turns
from beatrix_zenoh.settings import Settings

SEAT = "cleo"
"""The seat of all programs."""
LOOKS = """
from beatrix_zenoh import Robot
with Robot() as robot, robot.lease():
    robot.look(yaw=10)
    print("reached", round(robot.positions().head.yaw), robot.side)
"""
WAITS = """
import time
from beatrix_zenoh import Robot
with Robot() as robot:
    robot.look(yaw=10)
    print("there", flush=True)
    time.sleep(60)
"""
TURNS = """
from beatrix_zenoh import Robot
with Robot() as robot:
    while True:
        print("there", flush=True)
        robot.look(yaw=30, speed=10)
        robot.look(yaw=-30, speed=10)
"""
FAST = "from beatrix_zenoh import Robot\nRobot().look(yaw=20, speed=80)\n"


@pytest.fixture
def free(shell: Shell) -> Shell:
    wait_until_free(shell, SEAT)
    return shell


def written(folder: Path, text: str) -> program.Program:
    path = folder / "start.py"
    path.write_text(text)
    return program.read(path)


def take(free: Shell, made: program.Program) -> None:
    turns.take_turn(made, Settings(NAME, free.endpoint, SEAT), "hw", 5.0)


def home(robot: Robot) -> bool:
    return abs(robot.positions().head.yaw) < 0.5


def assert_home_and_free(free: Shell) -> None:
    with free.robot("hw") as robot:
        assert home(robot)
        assert robot.status().lease == 0


def test_a_program_runs_on_the_robot_which_is_then_home_and_free(
    free: Shell, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    take(free, written(tmp_path, LOOKS))
    assert "reached 10 hw" in capsys.readouterr().out
    assert_home_and_free(free)


def test_a_program_with_an_error_or_too_fast_ends_and_the_head_goes_home(free: Shell, tmp_path: Path) -> None:
    with pytest.raises(Refused, match=r"ended with an error: .*40.*\(line 2\)\."):
        take(free, written(tmp_path, FAST))
    assert_home_and_free(free)


@pytest.mark.long("a turn in real time")
def test_a_program_that_does_not_end_is_ended(
    free: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(turns, "LONGEST_S", 18.0)
    with pytest.raises(Refused, match="did not end within 3 s"):
        take(free, written(tmp_path, TURNS))
    with free.robot("hw") as robot:
        assert home(robot), "although the end of a motion by Ctrl-C is a STOP of this seat"
    output = capsys.readouterr()
    assert "there" in output.out
    assert "Traceback" not in output.out
    assert "not home" not in output.err


def test_a_seat_has_one_turn_at_a_time(free: Shell, tmp_path: Path) -> None:
    with (
        Robot(NAME, "hw", connect=free.endpoint, who=SEAT) as robot,
        robot.lease(),
        pytest.raises(Refused, match=r"Your seat, cleo, has taken .* already"),
    ):
        take(free, written(tmp_path, LOOKS))


def test_stop_of_another_seat_ends_the_turn_and_the_head_stays(free: Shell, tmp_path: Path) -> None:
    with free.robot("hw") as robot:

        def press() -> None:
            until(lambda: abs(robot.positions().head.yaw - 10) < 0.5, "the program looks")
            robot.stop()

        pressing = threading.Thread(target=press)
        pressing.start()
        with pytest.raises(Refused, match="has pressed STOP") as refused:
            take(free, written(tmp_path, WAITS))
        pressing.join()
        assert refused.value.reason is Reason.STOPPED
        assert not home(robot)
        assert robot.status().lease == 0


def test_a_program_that_has_not_passed_gets_no_turn(free: Shell, tmp_path: Path) -> None:
    assert free.run("lesson", "start", "1", cwd=tmp_path).returncode == 0
    refused = free.run("lesson", "turn", "1", cwd=tmp_path)
    assert (refused.returncode, "has not passed yet" in refused.stderr) == (1, True)
    space = progress.workspace(tmp_path)
    space.record("01-hello").passed = [progress.sealed("01-hello", "0" * 64)]
    space.save()
    assert "has changed since it passed" in free.run("lesson", "turn", "1", cwd=tmp_path).stderr


def test_a_turn_calibrates_no_robot(free: Shell, tmp_path: Path) -> None:
    with free.robot("hw") as robot:
        robot.disable()
        with pytest.raises(Refused, match="Set its head upright") as refused:
            take(free, written(tmp_path, LOOKS))
        assert refused.value.reason is Reason.NOT_CALIBRATED
        robot.make_ready()


def test_the_killed_verb_leaves_no_motion_and_a_free_robot(free: Shell, tmp_path: Path) -> None:
    (tmp_path / "lessons/01-hello").mkdir(parents=True)
    made = written(
        tmp_path / "lessons/01-hello",
        WAITS.replace("time.sleep(60)", "[robot.look(yaw=y, speed=20) for y in (-10, 10) * 9]"),
    )
    space = progress.workspace(tmp_path)
    space.record("01-hello").passed = [progress.sealed("01-hello", made.sha256)]
    space.save()
    words = (sys.executable, *CLI, "lesson", "turn", "1", "--who", SEAT, "--name", NAME)
    killed = subprocess.Popen(words, cwd=tmp_path, env=free.environment())
    with free.robot("hw") as robot:
        until(
            lambda: robot.status().lease != 0 and robot.status().moving, "the program moves the robot", 20.0
        )
        killed.send_signal(signal.SIGKILL)
        killed.wait()
        until(lambda: robot.status().holder == "", "the robot is free")
        until(lambda: not robot.status().moving, "its arms have braked", 5.0)
