"""Robots with a port for old programs, and robots to type at."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from old_program import Place
from shell import Shell, both, wait_until_free
from stage import Stage


@pytest.fixture(scope="module", params=["sim", "hw"])
def place(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Place]:
    path = tmp_path_factory.mktemp("legacy") / "COM4"
    with Stage() as stage:
        if request.param == "sim":
            stage.simulation("bea", "--legacy", str(path))
        else:
            virtual = ("--port", "virtual:", "--legacy", str(path))
            stage.process("hw_node", "--name", "bea", "--connect", stage.endpoint, *virtual).expect("ready")
        yield Place(stage, request.param, path)


@pytest.fixture(scope="module")
def shell() -> Iterator[Shell]:
    with both() as made:
        yield made


@pytest.fixture
def free(shell: Shell) -> Shell:
    wait_until_free(shell)
    return shell
