"""`beatrix sim` with faults that a test puts in: for each line `FAULT ROBOT` of its input one robot fails.

raise: its next turn raises an exception;
calibrate: the next CALIBRATE raises an exception in the thread of its controller.
"""

from __future__ import annotations

import sys
import threading
import unittest.mock

from sim_node import app
from sim_node.body import Simulation

FAULTS: dict[str, str] = {}


class FaultySimulation(Simulation):
    """A simulation that fails once for each fault that is put in."""

    def __init__(self, name: str, *arguments: object, **options: object) -> None:
        super().__init__(name, *arguments, **options)  # type: ignore[arg-type]
        self._name = name

    def turn(self, *, written: bool) -> None:
        if FAULTS.get(self._name) == "raise":
            del FAULTS[self._name]
            raise RuntimeError("put in by a test")
        super().turn(written=written)

    def straighten(self) -> None:
        if FAULTS.get(self._name) == "calibrate":
            del FAULTS[self._name]
            raise RuntimeError("put in by a test")
        super().straighten()


def read_faults() -> None:
    """Put in the faults of the input."""
    for line in sys.stdin:
        fault, name = line.split()
        FAULTS[name] = fault


if __name__ == "__main__":
    threading.Thread(target=read_faults, daemon=True).start()
    with unittest.mock.patch("sim_node.app.Simulation", FaultySimulation):
        sys.exit(app.main())
