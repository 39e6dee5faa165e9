"""The user's own gestures: choreographies in one folder, whose names are those of their files."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

FOLDER: Final = ("beatrix-programs", "gestures")
"""Below the home folder."""
NAME: Final = re.compile(r"[\w-](?:[\w -]{0,22}[\w-])?")
"""What a name may be; the text of a program contains it between quotes."""
LONGEST: Final = 24
"""Number of characters of the longest name."""
DEVICES: Final = re.compile(r"(?i)con|prn|aux|nul|com\d|lpt\d")
"""Names that Windows keeps for devices, whatever their ending."""
NAMES: Final = "a name has up to 24 letters, digits, - and _. Rename the file."
LARGEST_BYTES: Final = 1 << 14
"""Largest size of a gesture: about 300 poses."""
MOST: Final = 48
"""Largest number of gestures that window and page show."""
EMOJI: Final = re.compile(r'(?m)^"?#\s*emoji:\s*([^\s,;"]{1,8})')
"""The comment with the emoji of a gesture, also after a spreadsheet has saved it."""


def folder() -> Path:
    """Return the folder of this user; it need not exist."""
    return Path.home().joinpath(*FOLDER)


def possible(name: str) -> bool:
    """Return whether a gesture may have this name."""
    return bool(NAME.fullmatch(name)) and not DEVICES.fullmatch(name)


def file_of(name: str, *before: Path) -> Path | None:
    """Return the file of the gesture with this name; None if there is none. Folders `before` that of the user count first."""
    paths = (place / f"{name}.csv" for place in (*before, folder()) if possible(name))
    return next((path for path in paths if path.is_file()), None)


def emoji_of(text: str) -> str:
    """Return the emoji of a gesture file; empty: it has none."""
    found = EMOJI.search(text)
    return found[1] if found else ""


def with_emoji(text: str, emoji: str) -> str:
    """Return the text of a gesture file with another emoji."""
    if EMOJI.search(text):
        return EMOJI.sub(lambda found: found[0][: found.start(1) - found.start()] + emoji, text, count=1)
    return f"# emoji: {emoji}\n{text}"
