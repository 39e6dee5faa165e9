"""The words of a class: whoever types one on the control page gets its seat; the file stays with the teacher."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.contract.errors import quoted, wrong_usage
from beatrix_zenoh.contract.names import TEACHER

FILE: Final = "words.toml"
LONGEST: Final = 64 * 1024
"""Largest size of the file (bytes)."""
LETTERS: Final = "abcdefghjkmnpqrstuvwxyz23456789"
"""Letters that look alike in no handwriting."""
LENGTH, LENGTH_TEACHER = 6, 10
"""Length of a word: 887 million words of a pupil, and the teacher's can do more."""


class Words(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The contents of the file."""

    secret: str
    """signs the cookies of browsers that have typed a word"""
    words: dict[str, str]
    """word by seat; the teacher has one, too"""


def read(folder: Path) -> Words:
    """Read the words of the class in a folder; raises WrongUsage (BAD_VALUE) if they are missing or invalid."""
    try:
        return msgspec.convert(files.toml(folder / FILE, LONGEST), Words)
    except (OSError, msgspec.ValidationError) as error:
        raise wrong_usage(
            f"{folder / FILE} cannot be read: {error}. `beatrix classroom init class.toml` makes a new one if you delete it."
        ) from error


def update(folder: Path, seats: Iterable[str]) -> Words:
    """Return the words of these seats and the teacher, and store them; existing ones stay, the others get a new one."""
    old = read(folder) if (folder / FILE).is_file() else Words(secrets.token_urlsafe(32), {})
    words = {seat: old.words.get(seat) or _new(seat) for seat in (TEACHER, *seats)}
    return _store(folder, Words(old.secret, words))


def renew(folder: Path, seat: str) -> Words:
    """Give a seat another word, so that browsers with the old one have to log in again.

    Raises WrongUsage (BAD_VALUE) for an unknown seat.
    """
    old = read(folder)
    if seat not in old.words:
        raise wrong_usage(
            f"The class has no seat {quoted(seat)}. Its seats are: {', '.join(sorted(old.words))}."
        )
    return _store(folder, Words(old.secret, old.words | {seat: _new(seat)}))


def seat_of(words: Words, typed: str) -> str:
    """Return the seat whose word was typed; empty: it is the word of no seat. Takes as long for each text of the same length."""
    given = "".join(typed.split()).lower().encode()
    found = [seat for seat, word in words.words.items() if hmac.compare_digest(word.encode(), given)]
    return found[0] if found else ""


def _new(seat: str) -> str:
    length = LENGTH_TEACHER if seat == TEACHER else LENGTH
    return "".join(secrets.choice(LETTERS) for _ in range(length))


def _store(folder: Path, words: Words) -> Words:
    files.write_private(
        folder / FILE, "# Keep this file private.\n" + files.toml_text(msgspec.to_builtins(words))
    )
    return words
