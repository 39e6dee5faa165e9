"""The bodies on which contract tests run: robots of several kinds, each on a stage of its own."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
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
    """Parametrize a test that uses this fixture with the bodies in its mark `bodies`, or with all bodies."""
    if fixture in metafunc.fixturenames:
        mark = metafunc.definition.get_closest_marker("bodies")
        chosen = [
            pytest.param(name, marks=pytest.mark.long("firmware of the Mega in real time"))
            if name == "mega"
            else name
            for name in (mark.args if mark else bodies)
        ]
        metafunc.parametrize(fixture, chosen, indirect=True)
