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
        ("not motion.done", "done is a method: write done()"),
        ("robot.position()", "Robot has no 'position': did you mean positions()?"),
        ("robot.lookat(3)", "Robot has no 'lookat': did you mean look_at(…)?"),
        ("robot.turn(30)", "Robot has no 'turn': it has begin, calibrate, camera, "),
        ("motion.is_done()", "Motion has no 'is_done': did you mean done()?"),
        ("stream.jpeg", "Subscription has no 'jpeg': it has arrivals, close, "),
    ],
)
def test_the_error_of_a_slip_names_what_was_meant(slip: str, meant: str) -> None:
    with pytest.raises((AttributeError, TypeError)) as error:
        eval(slip, NAMES.copy())
    assert str(error.value).startswith(meant)
