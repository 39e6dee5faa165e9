"""Outputs of a recorder: files and viewers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.recording.about import About
from beatrix_zenoh.recording.figure import Figure
from beatrix_zenoh.recording.rows import Row

Say = Callable[[str], None]
"""A function that shows a sentence to the user."""


@dataclass(frozen=True)
class RobotSet:
    """The robots found so far, and those that have sent pictures."""

    robots: Mapping[Place, Figure]
    with_pictures: frozenset[Place] = frozenset()

    @property
    def names(self) -> list[str]:
        """Names of the robots, without duplicates."""
        return sorted({name for name, _ in self.robots})

    def sides(self, name: str) -> list[Place]:
        """Return the sides of one robot, the simulation first."""
        return [(name, side) for side in ("sim", "hw") if (name, side) in self.robots]


class Output(Protocol):
    """A file or a viewer; used by the recorder's thread only."""

    def show(self, robots: RobotSet) -> None:
        """Set the robots of the recording."""
        ...

    def describe(self, about: About) -> None:
        """Set what the recording says of itself."""
        ...

    def write(self, rows: Sequence[Row]) -> None:
        """Add rows, which `update` writes."""
        ...

    def update(self, now_s: float) -> bool:
        """Write the rows that are due at `now_s` (monotonic clock).

        Returns True if the output has restarted and needs all poses and states again.
        """
        ...

    def close(self) -> bool:
        """Write the remaining rows and close; return False if that fails or takes too long."""
        ...
