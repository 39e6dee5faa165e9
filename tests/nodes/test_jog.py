"""`beatrix doctor --jog`, as a person in front of a new robot uses it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator

import pytest
from stage import ROOT, Stage, ready

RIGHT = "short\ncounter\nmiddle\ncounter\nlong\ncounter\n90\n"


@pytest.fixture
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


def jog(stage: Stage, answers: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "beatrix_zenoh.cli",
            "doctor",
            "--jog",
            "--name",
            "bea",
            "--connect",
            stage.endpoint,
        ],
        input=answers,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        cwd=ROOT,
        env=dict(os.environ, BEATRIX_WHO="ana"),
    )


@pytest.mark.parametrize(
    ("answers", "advice"),
    [
        (RIGHT, ["All three are plugged in right."]),
        (
            "m\nc\ncounter\ns\nclock\nl\ncounter\n30\n",
            [
                "Move the motor of the middle arm from X to Y.",
                "Move the motor of the short arm from Y to X.",
                "Turn the plug of the short arm's motor round",
                "arm0_azimuth = 30.0",
            ],
        ),
        ("s\ncounter\ns\ncounter\nl\ncounter\n90\n", ["each arm should turn once"]),
    ],
)
def test_three_jogs_tell_what_is_plugged_in_wrong(stage: Stage, answers: str, advice: list[str]) -> None:
    stage.hardware("bea")
    robot = ready(stage.robot("bea", "hw"))
    done = jog(stage, answers)
    for line in advice:
        assert line in done.stdout + done.stderr
    assert robot.positions().commanded == pytest.approx((0, 0, 0), abs=0.1)


def test_a_robot_that_may_not_move_says_what_it_lacks(stage: Stage) -> None:
    stage.hardware("bea")
    done = jog(stage, RIGHT)
    assert done.returncode == 1
    assert "enable" in done.stderr
