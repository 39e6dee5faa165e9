"""Fixtures of the contract tests: the kinds of robot (bodies) on which each test runs, unless a mark selects fewer."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from bodies import Body, run_on_bodies
from robots import Stage, ready

from beatrix_zenoh import Robot
from hw_node.body import VirtualHardware
from hw_node.cameras.camera import TEST_EYES
from hw_node.microphones import RepeatedSound, microphone_sensor, tone

BODIES = ("sim", "in-process", "mega")
"""A simulation; a node of this process with a virtual board; the hardware node with the firmware on a simulated
Mega."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    run_on_bodies(metafunc, "body", BODIES)


@pytest.fixture(scope="session")
def body(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Body]:
    """Yield a body of one kind, shared by all tests on this kind."""
    kind: str = request.param
    with Stage() as stage:
        if kind == "sim":
            stage.simulation("bea")
        elif kind == "shared":
            stage.process("sim_node", "--name", "bob", "--name", "bea", "--connect", stage.endpoint).expect(
                "ready beatrix/bea/"
            )
        elif kind == "mega":
            path = tmp_path_factory.mktemp("mega") / "board"
            stage.mega(path)
            stage.hardware("bea", str(path), "--microphones", "tone")
        else:
            sensors = [*TEST_EYES, lambda node: microphone_sensor(node, RepeatedSound("tone", tone()))]
            stage.node("bea", VirtualHardware("bea", sensors=sensors))
        yield Body(kind, stage, "bea", "hw" if kind in ("in-process", "mega") else "sim")


@pytest.fixture
def robot(body: Body) -> Iterator[Robot]:
    """A client of the seat ana; the robot is at home, enabled and calibrated. All clients close after the test."""
    robot = body.robot()
    robot.stop()
    robot.disable()
    ready(robot)
    yield robot
    robot.stop()
    body.stage.close_clients()
