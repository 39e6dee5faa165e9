"""`beatrix doctor --jog`, as the user of a new robot runs it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys

import pytest
from robots import END_S, ROOT, Stage, ready, until, untraced
from shell import CLI, beatrix

SHORT_RIGHT = "short\nccw\n"
RIGHT = SHORT_RIGHT + "middle\ncounter\nlong\nanticlockwise\n"
BACK_AT = 0.1
"""Tolerance (deg); a microstep is 0.086 deg."""


@pytest.fixture(autouse=True)
def small_and_fast(monkeypatch: pytest.MonkeyPatch) -> None:
    """Turn the arms fast and by small angles, because no user watches them."""
    monkeypatch.setattr("beatrix_zenoh.doctor.verbs.JOG_DEG", 3.0)
    monkeypatch.setattr("beatrix_zenoh.doctor.verbs.SPEED_DEG_S", 80.0)


def words(alone: Stage, *more: str) -> list[str]:
    """Return the arguments of `beatrix`."""
    return ["doctor", "--jog", "--name", "bea", "--connect", alone.endpoint, "--who", "ana", *more]


def jog(alone: Stage, answers: str, *more: str) -> subprocess.CompletedProcess[str]:
    return beatrix(*words(alone, *more), answers=answers)


@pytest.mark.long("all wrong plugs in real time")
@pytest.mark.parametrize(
    ("answers", "advice", "missing"),
    [
        (RIGHT, ["All three motors are plugged in correctly."], "Switch"),
        (
            "m\nc\ncounter\ns\ncw\nl\ncc\n",
            [
                "Switch the power off first.",
                "Move the motor of the middle arm from X to Y.",
                "Move the motor of the short arm from Y to X.",
                "Reverse the plug of the short arm's motor",
                "Then type `beatrix enable --on hw`, `beatrix calibrate --on hw`, and repeat `beatrix doctor --jog`.",
            ],
            "No arm turned",
        ),
        (
            SHORT_RIGHT + "none\nl\ncw\n",
            [
                "No arm turned for Y, on which the middle arm belongs: check the motor power",
                "reference voltage",
                "Reverse the plug of the long arm's motor",
            ],
            "No arm turned for X",
        ),
        ("s\nccw\ns\nccw\nl\nccw\n", ["each arm turns once"], "Switch"),
    ],
    ids=["right", "swapped", "silent", "twice"],
)
def test_three_jogs_find_wrong_plugs(alone: Stage, answers: str, advice: list[str], missing: str) -> None:
    alone.node("bea")
    robot = ready(alone.robot("bea", "hw"))
    done = jog(alone, answers)
    for line in advice:
        assert line in done.stdout + done.stderr
    assert missing not in done.stdout + done.stderr
    assert done.returncode == (0 if advice[0].startswith("All") else 1)
    assert robot.positions().commanded == pytest.approx((0, 0, 0), abs=BACK_AT)


def test_with_motors_off_jog_is_refused_before_any_question_and_names_enable_for_the_hardware(
    alone: Stage,
) -> None:
    """Without --on, `beatrix enable` would choose a simulation of the same name."""
    alone.node("bea")
    done = jog(alone, RIGHT)
    assert (done.returncode, "`beatrix enable --on hw`" in done.stderr) == (1, True)
    assert "Watch the robot" not in done.stderr, "refused before any question"


def test_ctrl_c_at_a_question_stops_the_robot_and_ends_the_program(alone: Stage) -> None:
    alone.node("bea")
    robot = ready(alone.robot("bea", "hw"))
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        [sys.executable, *CLI, *words(alone, "--json")],
        stdin=pipe,
        stdout=pipe,
        stderr=pipe,
        text=True,
        cwd=ROOT,
        env=untraced(),
    )
    assert process.stderr is not None
    prompt = ""
    while not prompt.endswith("or none: "):
        prompt += os.read(process.stderr.fileno(), 1000).decode()
    until(lambda: not robot.status().moving, "the program waits for an answer")
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=END_S)
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert "the arms rest" in json.loads(out)["message"]
