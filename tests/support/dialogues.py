"""Recorded commands and replies of firmware 1.0 of 2023: the reference for all text ports."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

DIALOGUES = sorted((Path(__file__).parents[1] / "firmware/dialogues").glob("*.txt"))


class Entry(NamedTuple):
    """One line of a dialogue."""

    to_robot: bool
    ms: int
    text: str


def read(path: Path) -> list[Entry]:
    """Return the entries of a recorded dialogue, with escapes resolved."""
    entries = []
    for line in path.read_text(encoding="ascii").splitlines():
        if not line.startswith("#"):
            direction, ms, text = line.split(" ", 2)
            entries.append(Entry(direction == ">", int(ms), text.replace("\\r", "\r").replace("\\n", "\n")))
    return entries


def expected_replies(dialogue: list[Entry]) -> list[Entry]:
    """Return the recorded replies; for @STOPALL those of this firmware, because its second reply has changed."""
    replies, command, count = [], "", 0
    for entry in dialogue:
        if entry.to_robot:
            command, count = entry.text, 0
        else:
            count += 1
            stop = command == "@STOPALL\r" and count == 2
            replies.append(entry._replace(text="ACK\n") if stop else entry)
    return replies
