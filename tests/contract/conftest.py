"""The bodies every contract test runs against."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from body import Body
from stage import Stage, ready

from beatrix_zenoh import Robot

BODIES = ("sim", "hw", "in-process", "mega")


@pytest.fixture(scope="module", params=BODIES)
def body(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Body]:
    """One body, shared by the tests of a file."""
    kind: str = request.param
    with Stage() as stage:
        if kind == "sim":
            stage.simulation("bea")
        elif kind == "hw":
            stage.hardware("bea")
        elif kind == "mega":
            path = tmp_path_factory.mktemp("mega") / "board"
            stage.mega(path)
            stage.hardware("bea", str(path))
        else:
            stage.node("bea")
        yield Body(kind, stage, "bea", "sim" if kind == "sim" else "hw")


@pytest.fixture
def robot(body: Body) -> Iterator[Robot]:
    """The robot at home, enabled and calibrated, driven by ana."""
    robot = body.robot()
    robot.stop()
    robot.disable()
    ready(robot)
    yield robot
    robot.stop()
    robot.client.close()
