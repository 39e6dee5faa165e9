"""`beatrix doctor --jog`, as a person in front of a new robot uses it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from stage import ROOT, UNTRACED, Stage, ready, until

SHORT_RIGHT = "short\nccw\n"
RIGHT = SHORT_RIGHT + "middle\ncounter\nlong\nanticlockwise\n"
AZIMUTH = "90\n"
BACK_AT = 0.1
"""deg: a microstep is 0.086"""


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def words(stage: Stage, *more: str) -> list[str]:
    """What is typed."""
    command = [sys.executable, "-m", "beatrix_zenoh.cli", "doctor", "--jog", "--name", "bea"]
    return [*command, "--connect", stage.endpoint, "--who", "ana", *more]


def jog(stage: Stage, answers: str, *more: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        words(stage, *more), input=answers, capture_output=True, text=True, timeout=60, check=False, cwd=ROOT
    )


@pytest.mark.parametrize(
    ("answers", "advice", "missing"),
    [
        (RIGHT + AZIMUTH, ["All three are plugged in right."], "Switch"),
        (
            "m\nc\ncounter\ns\ncw\nl\ncc\n",
            [
                "Switch the power off first.",
                "Move the motor of the middle arm from X to Y.",
                "Move the motor of the short arm from Y to X.",
                "Turn the plug of the short arm's motor round",
                "Then `beatrix enable --on hw`, `beatrix calibrate --on hw`, and jog again.",
            ],
            "Nothing turned",
        ),
        (RIGHT + "30\n", ["[geometry]\narm0_azimuth = 30.0"], "Switch"),
        (
            SHORT_RIGHT + "none\nl\ncw\n",
            [
                "Nothing turned on Y, and the middle arm did not turn",
                "driver",
                "reference voltage",
                "Turn the plug of the long arm's motor round",
            ],
            "motor power",
        ),
        (
            "none\n" * 3,
            ["Nothing turned at all. Is the motor power on? USB alone", "and jog again."],
            "Nothing turned on",
        ),
        (
            "m\nccw\nnone\nl\nccw\n",
            [
                "Move the motor of the middle arm from X to Y.",
                "Nothing turned on Y, and the short arm did not turn",
                "it belongs on X",
            ],
            "the middle arm did not",
        ),
        (RIGHT + "90,5\n", ["All three are plugged in right."], "Type a number"),
        ("s\nccw\ns\nccw\nl\nccw\n", ["each arm should turn once"], "Switch"),
    ],
    ids=["right", "swapped", "elsewhere", "silent", "unpowered", "two", "comma", "twice"],
)
def test_three_jogs_tell_what_is_plugged_in_wrong(
    stage: Stage, answers: str, advice: list[str], missing: str
) -> None:
    stage.hardware("bea")
    robot = ready(stage.robot("bea", "hw"))
    done = jog(stage, answers)
    for line in advice:
        assert line in done.stdout + done.stderr
    assert missing not in done.stdout + done.stderr
    assert done.returncode == (0 if advice[0].startswith("All") else 1)
    assert ("Where does the short arm point" in done.stderr) == (answers.startswith(RIGHT))
    assert robot.positions().commanded == pytest.approx((0, 0, 0), abs=BACK_AT)


def test_it_asks_where_the_arms_are_at_home_wherever_they_were_before(stage: Stage) -> None:
    stage.hardware("bea")
    robot = ready(stage.robot("bea", "hw"))
    robot.look(yaw=10, speed=60)
    assert jog(stage, RIGHT + AZIMUTH).returncode == 0
    assert robot.positions().commanded == pytest.approx((0, 0, 0), abs=BACK_AT)


def test_an_azimuth_that_can_mean_nothing_is_asked_again(stage: Stage) -> None:
    stage.hardware("bea")
    ready(stage.robot("bea", "hw"))
    done = jog(stage, RIGHT + "1000\nnan\nleft\n" + AZIMUTH)
    assert done.returncode == 0
    assert done.stderr.count("(the robot says 90;") == 4
    assert done.stderr.count("Type a number from -360 to 360.") == 3


def test_arms_that_a_robot_file_has_put_elsewhere_are_right(stage: Stage, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text("[geometry]\narm0_azimuth = 30.0\n")
    where = ("--name", "bea", "--connect", stage.endpoint, "--port", "virtual:")
    stage.process("hw_node", *where, "--robot-file", str(tmp_path / "lab.toml")).expect("ready")
    ready(stage.robot("bea", "hw"))
    done = jog(stage, RIGHT + "30\n")
    assert (done.returncode, done.stdout) == (0, "All three are plugged in right.\n")
    elsewhere = jog(stage, RIGHT + AZIMUTH)
    assert elsewhere.returncode == 1
    assert "elsewhere than your robot file says (30 deg)" in elsewhere.stdout
    assert "[geometry]\narm0_azimuth = 90.0" in elsewhere.stdout


def test_motors_that_are_off_are_switched_on_for_the_board(stage: Stage) -> None:
    """Without --on the verbs would go to a simulation of that name."""
    stage.hardware("bea")
    done = jog(stage, "")
    assert (done.returncode, "`beatrix enable --on hw`" in done.stderr) == (1, True)


def test_what_is_found_is_one_json_document(stage: Stage) -> None:
    stage.hardware("bea")
    ready(stage.robot("bea", "hw"))
    done = jog(stage, "none\n" + RIGHT.removeprefix(SHORT_RIGHT), "--json")
    found = json.loads(done.stdout)
    assert (done.returncode, found["result"], len(found["todo"])) == (1, False, 3)


def test_a_robot_that_may_not_move_says_what_it_lacks_before_anybody_looks(stage: Stage) -> None:
    stage.hardware("bea")
    done = jog(stage, RIGHT)
    assert done.returncode == 1
    assert "enable" in done.stderr
    assert "Look at the robot" not in done.stderr


@pytest.mark.parametrize("answers", ["", "short\n", RIGHT], ids=["arm", "way", "azimuth"])
def test_input_that_ends_is_wrong_usage(stage: Stage, answers: str) -> None:
    stage.hardware("bea")
    ready(stage.robot("bea", "hw"))
    done = jog(stage, answers)
    assert (done.returncode, done.stdout) == (2, "")
    assert "The input has ended before all was answered" in done.stderr
    assert "Traceback" not in done.stderr


def test_input_that_ends_is_a_document_with_json(stage: Stage) -> None:
    stage.hardware("bea")
    ready(stage.robot("bea", "hw"))
    done = jog(stage, "", "--json")
    assert done.returncode == 2
    assert json.loads(done.stdout)["message"].startswith("The input has ended")


@pytest.mark.parametrize("more", [(), ("--json",)])
def test_interrupted_at_a_question_it_ends_as_all_verbs_do(stage: Stage, more: tuple[str, ...]) -> None:
    stage.hardware("bea")
    robot = ready(stage.robot("bea", "hw"))
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        words(stage, *more), stdin=pipe, stdout=pipe, stderr=pipe, text=True, cwd=ROOT, env=UNTRACED
    )
    assert process.stderr is not None
    asked = ""
    while not asked.endswith("or none: "):
        asked += os.read(process.stderr.fileno(), 1000).decode()
    until(lambda: not robot.status().moving, "it waits for an answer")
    process.send_signal(signal.SIGINT)
    out, said = process.communicate(timeout=10)
    assert process.returncode == 130
    assert "Traceback" not in said
    told = json.loads(out)["message"] if more else said
    assert "the arms rest" in told
