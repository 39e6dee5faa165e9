"""Slips of beginners: the error names what was meant."""

from __future__ import annotations

import asyncio
import inspect
import threading
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
        ("robot.camera.image", "camera is a method: write camera(…).image"),
        ("robot.positions().haed", "Reading has no 'haed': did you mean head?"),
        ("robot.head.yaw", "Robot has no 'head': it has begin, calibrate, camera, "),
        ("robot.status.enabled", "status is a method: write status().enabled"),
        ("robot.stream.latest", "stream is a method: write stream().latest"),
        ("twin.positions.sim", "positions is a method: write positions().sim"),
        ("not motion.done", "done is a method: write done()"),
        ("robot.position()", "Robot has no 'position': did you mean positions()?"),
        ("robot.lookat(3)", "Robot has no 'lookat': did you mean look_at(…)?"),
        ("robot.moveto(1, 2, 3)", "Robot has no 'moveto': did you mean move(…)?"),
        ("robot.turn(30)", "Robot has no 'turn': it has begin, calibrate, camera, "),
        ("motion.is_done()", "Motion has no 'is_done': did you mean done()?"),
        ("stream.jpeg", "Subscription has no 'jpeg': it has arrivals, close, "),
    ],
)
def test_the_error_of_a_slip_names_what_was_meant(slip: str, meant: str, names: dict[str, Any]) -> None:
    with pytest.raises((AttributeError, TypeError)) as error:
        eval(slip, names.copy())
    assert str(error.value).startswith(meant)


def test_a_value_method_behaves_as_a_method(names: dict[str, Any]) -> None:
    robot = names["robot"]
    assert repr(robot.positions) == "<method positions: write positions()>"
    assert (robot.positions.__name__, robot.positions.__doc__) == ("positions", Robot.positions.__doc__)
    assert list(inspect.signature(robot.camera).parameters) == ["eye", "timeout_s"]
    assert Robot.status(robot).robot == asyncio.run(asyncio.to_thread(robot.status)).robot == "bea1"
    thread = threading.Thread(target=robot.positions)
    thread.start()
    thread.join(10)
    assert not hasattr(robot, "_missing")
    assert not hasattr(robot, "__missing__")
