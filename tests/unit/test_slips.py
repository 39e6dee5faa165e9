"""Slips of beginners: the error names what was meant."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from robots import Stage

from beatrix_zenoh import Robot, Twin


@pytest.fixture(scope="module")
def names() -> Iterator[dict[str, Any]]:
    """A robot, a twin, a motion and a subscription, by their names in a program."""
    with Stage() as stage:
        stage.node("bea1")
        with (
            Twin("bea1", connect=stage.endpoint) as twin,
            Robot("bea1", "hw", connect=stage.endpoint) as robot,
        ):
            robot.make_ready()
            motion = robot.look(5, wait=False)
            with robot.stream() as stream:
                stream.next()
                yield {"robot": robot, "twin": twin, "motion": motion, "stream": stream}
            motion.result()


@pytest.mark.parametrize(
    ("slip", "meant"),
    [
        ("robot.positions.head", "positions is a method: write positions().head"),
        ("robot.positions().haed", "Reading has no 'haed': did you mean head?"),
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
def test_the_error_of_a_slip_names_what_was_meant(slip: str, meant: str, names: dict[str, Any]) -> None:
    with pytest.raises((AttributeError, TypeError)) as error:
        eval(slip, names.copy())
    assert str(error.value).startswith(meant)
