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
        ("robot.stream.latest", "stream is a method: write stream().latest"),
        ("twin.positions.sim", "positions is a method: write positions().sim"),
        ("robot.positon()", "'Robot' object has no attribute 'positon'"),
        ("not motion.done", "done is a method: write done()"),
    ],
)
def test_the_error_of_a_slip_names_what_was_meant(slip: str, meant: str, names: dict[str, Any]) -> None:
    with pytest.raises((AttributeError, TypeError)) as error:
        eval(slip, names.copy())
    assert str(error.value).startswith(meant)
