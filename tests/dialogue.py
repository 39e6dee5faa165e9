"""What firmware 1.0 of 2023 was told and answered, as measured: the reference for all text ports."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

DIALOGUES = sorted((Path(__file__).parent / "firmware/dialogues").glob("*.txt"))


class Said(NamedTuple):
    """One line of a dialogue."""

    to_robot: bool
    ms: int
    text: str


def read(path: Path) -> list[Said]:
    """A dialogue with its escapes resolved."""
    said = []
    for line in path.read_text(encoding="ascii").splitlines():
        if not line.startswith("#"):
            direction, ms, text = line.split(" ", 2)
            said.append(Said(direction == ">", int(ms), text.replace("\\r", "\r").replace("\\n", "\n")))
    return said


def wanted(dialogue: list[Said]) -> list[Said]:
    """The replies; to @STOPALL as ours are."""
    replies, asked, count = [], "", 0
    for said in dialogue:
        if said.to_robot:
            asked, count = said.text, 0
        else:
            count += 1
            stop = asked == "@STOPALL\r" and count == 2
            replies.append(said._replace(text="ACK\n") if stop else said)
    return replies
