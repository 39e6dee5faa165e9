"""What a program says of itself: its name, and the keys of all its sessions."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from beatrix_zenoh.bus.session import PUBLISHER, QUERYABLE, SUBSCRIBER, Bus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import ProgramInfo

COMMAND_LINES = ("beatrix", "beatrix.exe", "cli")
"""Names of programs whose first argument is a verb; `cli`: `python -m beatrix_zenoh.cli`."""


def describe(sessions: Iterable[Bus], side: str = "") -> ProgramInfo:
    """Return the description of this program; `side` is that of a node. Fast enough for Zenoh's threads."""
    buses = list(sessions)

    def declared(kind: str) -> list[str]:
        return sorted({key for bus in buses for key in bus.declared(kind)})

    return ProgramInfo(
        program=program_name(sys.argv),
        side=side,
        serves=[key for key in declared(QUERYABLE) if not _is_description(key)],
        publishes=declared(PUBLISHER),
        subscribes=declared(SUBSCRIBER),
        asks=sorted({key for bus in buses for key in bus.asked()}),
    )


def program_name(words: list[str]) -> str:
    """Return the name of the program with these command-line words: `lesson.py`, `beatrix gui` or `python`."""
    path = Path(words[0] if words else "")
    name = path.parent.name if path.name == "__main__.py" else path.name
    if name in COMMAND_LINES:
        return " ".join(["beatrix", *words[1:2]])
    return "python" if name in ("", "-c") else name


def _is_description(key: str) -> bool:
    parts = keys.parse(key)
    return parts is not None and parts.row == "program"
