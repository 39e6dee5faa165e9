"""A node's Zenoh sessions: what floods one road does not hold up the others."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Self

from beatrix_zenoh.bus import Bus


@dataclass(frozen=True)
class Roads:
    """Zenoh delivers all of a session in order over one connection; so each kind of traffic has its own."""

    commands: Bus
    """STOP, commands, presence and publications."""
    motions: Bus
    """Motions, poses and per-arm targets."""
    questions: Bus
    """Questions about state, and previews."""

    @classmethod
    def open(cls, connect: Callable[[], Bus]) -> Self:
        """Open all of them, or none; raises what `connect` does."""
        with ExitStack() as undo:
            buses = []
            for _ in cls.__dataclass_fields__:
                buses.append(connect())
                undo.callback(buses[-1].close)
            undo.pop_all()
        return cls(*buses)

    def close(self) -> None:
        """Leave; the presence last."""
        self.questions.close()
        self.motions.close()
        self.commands.close()
