"""Text from the network as one printable line of bounded length, so that it cannot forge lines of tables and logs."""

from __future__ import annotations

import re
from functools import cache
from typing import Final, get_args

from beatrix_zenoh.contract._generated.messages import Label, Name, Text

_OTHER: Final = re.compile(r"[^a-z0-9-]")


@cache
def longest(kind: object) -> int:
    """Return the largest number of characters of a text of this kind: Name, Label or Text."""
    found: int = get_args(kind)[1].extra["longest"]
    return found


def name(text: str) -> str:
    """Return a name of a robot or seat, cut if it is too long, with `?` for each invalid character."""
    return _OTHER.sub("?", text[: longest(Name)])


def label(text: str) -> str:
    """Return a technical text as one line."""
    return line(text, longest(Label))


def line(text: str, most: int = longest(Text)) -> str:
    """Return a text as one line of at most `most` characters.

    Line feeds, tabs and unusual spaces become spaces. `?` replaces other characters that are not printable: escape
    sequences, and marks that reverse the direction of writing.
    """
    if len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else " " if c.isspace() else "?" for c in text)
