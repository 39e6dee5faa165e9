"""What every contract test runs against."""

from __future__ import annotations

from dataclasses import dataclass

from stage import Stage

from beatrix_zenoh import Robot


@dataclass(frozen=True)
class Body:
    """A robot under test on a stage of its own."""

    kind: str
    stage: Stage
    name: str
    twin: str

    def robot(self, who: str = "ana") -> Robot:
        """The robot through another session."""
        return self.stage.robot(self.name, self.twin, who)
