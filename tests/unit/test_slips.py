"""Slips of beginners: the error names what was meant."""

from __future__ import annotations

import pytest

from beatrix_zenoh import Robot, Twin
from beatrix_zenoh.client.degrees import Reading
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.subscription import Subscription

NAMES = {
    "robot": Robot.__new__(Robot),
    "twin": Twin.__new__(Twin),
    "motion": Motion.__new__(Motion),
    "stream": Subscription.__new__(Subscription),
    "reading": Reading.__new__(Reading),
}
"""Objects of a program by their names, without a robot: a slip is found in their class."""


@pytest.mark.parametrize(
    ("slip", "meant"),
    [
        ("robot.positions.head", "positions is a method: write positions().head"),
        ("reading.haed", "Reading has no 'haed': did you mean head?"),
        ("robot.head.yaw", "Robot has no 'head': it has begin, calibrate, camera, "),
        ("robot.stream.latest", "stream is a method: write stream().latest"),
        ("twin.positions.sim", "positions is a method: write positions().sim"),
        ("robot.positon()", "Robot has no 'positon': did you mean positions()?"),
        ("not motion.done", "done is a method: write done()"),
    ],
)
def test_the_error_of_a_slip_names_what_was_meant(slip: str, meant: str) -> None:
    with pytest.raises((AttributeError, TypeError)) as error:
        eval(slip, NAMES.copy())
    assert str(error.value).startswith(meant)
