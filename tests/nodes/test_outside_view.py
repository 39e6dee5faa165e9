"""The outside view of a simulation: drawn while a client subscribes, with a lower priority than the eyes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pytest
from robots import Process, Stage
from simulated_pictures import fresh

from beatrix_zenoh import Robot
from sim_node.renderer import HEIGHT


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as stage:
        yield stage


@pytest.fixture(scope="module")
def sim(stage: Stage) -> Process:
    return stage.simulation("bea", "--ready")


@pytest.fixture
def robot(stage: Stage, sim: Process) -> Iterator[Robot]:
    robot = stage.robot("bea", "sim")
    yield robot
    robot.look(speed=80)
    robot.client.close()


def test_the_outside_view_shows_the_head(robot: Robot) -> None:
    with robot.camera("outside") as images:
        home = fresh(images)
        assert not any(eye.streaming for eye in robot.status().cameras), (
            "no eye is drawn for the outside view"
        )
        robot.look(roll=20, speed=60)
        tilted = fresh(images)
    iris = irises(home)
    assert abs(iris[0][1] - iris[1][1]) < 15, "both irises have the same height"
    assert 60 < iris[1][0] - iris[0][0] < 160, "the face is large in the picture"
    iris = irises(tilted)
    assert iris[1][1] - iris[0][1] < -20, "the robot's right ear is down, that is at the left of the picture"


def irises(picture: npt.NDArray[np.uint8]) -> list[tuple[float, float]]:
    """Return column and row (px) of the irises of the robot's face, from the left to the right of the picture."""
    face = picture[: HEIGHT * 2 // 3]  # the rings below are blue and green
    red, green, blue = (face[..., colour].astype(int) for colour in range(3))
    rows, columns = np.nonzero((red < 50) & (green > 80) & (blue > green) & (blue < 1.4 * green))
    assert len(rows) > 200, "the face is not in the picture"
    middle = (
        columns.mean()
    )  # not the middle of the outermost pixels, because a pixel of the room may have the same colour
    return [
        (float(np.median(columns[side])), float(np.median(rows[side])))
        for side in (columns < middle, columns > middle)
    ]
