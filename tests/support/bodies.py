"""The bodies on which contract tests run: robots of several kinds, each on a stage of its own."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from _pytest.mark import ParameterSet
from robots import Stage

from beatrix_zenoh import Robot

EVERY = ("sim", "in-process", "mega", "shared")
"""All kinds of bodies. `shared` is a simulation beside others in one process: its node is that of `sim`, so only tests of
motions, states and STOP run on it."""


@dataclass(frozen=True)
class Body:
    """A robot under test on a stage of its own."""

    kind: str
    stage: Stage
    name: str
    side: str

    def robot(self, who: str = "ana") -> Robot:
        """Return the robot, through a new session of a seat."""
        return self.stage.robot(self.name, self.side, who)


def run_on_bodies(metafunc: pytest.Metafunc, fixture: str, bodies: tuple[str, ...]) -> None:
    """Parametrize a test that uses this fixture with the bodies in its mark `bodies`, or with all bodies.

    Where a test also runs in-process, its other bodies are `long`, unless the mark has `safety=True`.
    """
    if fixture in metafunc.fixturenames:
        mark = metafunc.definition.get_closest_marker("bodies")
        names = mark.args if mark else bodies
        safety = mark is not None and mark.kwargs.get("safety", False)
        metafunc.parametrize(fixture, [chosen(name, names, safety) for name in names], indirect=True)


def chosen(name: str, names: tuple[str, ...], safety: bool) -> ParameterSet | str:
    """Return the parameter for one of the bodies of a test, with the mark `long` where it has a reason."""
    if name == "mega":
        return pytest.param(name, marks=pytest.mark.long("firmware of the Mega in real time"))
    if name in ("sim", "shared") and "in-process" in names and not safety:
        return pytest.param(name, marks=pytest.mark.long("runs on the in-process body in `make test`"))
    return name
