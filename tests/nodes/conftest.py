"""Fixtures: both robots of one name, robots with a port for old programs, robots for the command line."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from bodies import run_on_bodies
from old_programs import Place
from robots import Stage
from shell import Shell, both, wait_until_free

from beatrix_zenoh import Twin


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    run_on_bodies(metafunc, "place", ("sim", "hw"))


@pytest.fixture(scope="module")
def stage(bea: Stage) -> Iterator[Stage]:
    """Simulation and virtual robot `bea`; a file that needs others has a fixture of its own."""
    yield bea
    bea.close_clients()


@pytest.fixture(scope="module")
def router() -> Iterator[Stage]:
    """A router without robots for the tests of a file."""
    with Stage() as made:
        yield made


@pytest.fixture
def alone() -> Iterator[Stage]:
    """A router for one test."""
    with Stage() as made:
        yield made


@pytest.fixture
def twin(stage: Stage) -> Iterator[Twin]:
    """Both robots, enabled and calibrated, without an emergency latch."""
    with Twin("bea", connect=stage.endpoint, who="ana", timeout_s=10.0) as made:
        made.stop()
        made.reset()
        made.disable()
        made.enable()
        made.calibrate()
        yield made
        made.stop()


@pytest.fixture(scope="module")
def place(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Place]:
    path = tmp_path_factory.mktemp("legacy") / "COM4"
    with Stage() as stage:
        if request.param == "sim":
            stage.simulation("bea", "--legacy", str(path))
        else:
            stage.hardware("bea", "virtual:", "--legacy", str(path))
        yield Place(stage, request.param, path)


@pytest.fixture(scope="session")
def shell() -> Iterator[Shell]:
    with both() as made:
        yield made


@pytest.fixture
def free(shell: Shell) -> Shell:
    wait_until_free(shell)
    return shell
