"""The seats of a class on its page: which browser has which seat, its account, and the robots that it may use."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from beatrix_zenoh import account as accounts
from beatrix_zenoh import class_words as words
from beatrix_zenoh.account import Account
from beatrix_zenoh.class_file import Classroom
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import TEACHER
from gui.page.protection import Entry, Guesses

WRONG_MAX: Final = 60
"""Largest number of wrong words of one address within a minute: a whole class may be behind one."""
LOOK_S: Final = 1.0
"""Period of the look whether words were replaced."""


class Seats:
    """Logs browsers in by the word of a seat; all methods run on the thread of the server's loop."""

    kind = "word"

    def __init__(self, classroom: Classroom, folder: Path) -> None:
        """Read the words; raises WrongUsage (BAD_VALUE) if that fails."""
        self.folder, self._classroom = folder, classroom
        self.addresses: Sequence[str] = classroom.addresses
        self._words = words.read(folder)
        self.secret = self._words.secret
        """what signs the cookies: browsers stay logged in when the server starts again"""
        self._changed_ns = self._stamp()
        self._looked_s = 0.0
        self._guesses = Guesses(WRONG_MAX)

    def enter(self, typed: str, address: str, now_s: float) -> Entry:
        """Check a word, and count a wrong one."""
        if wait_s := self._guesses.wait_s(address, now_s):
            return Entry(refusal="page.wait", wait_s=wait_s)
        self._look(now_s)
        seat = words.seat_of(self._words, typed)
        if seat:
            return Entry(f"{seat}:{self._words.words[seat]}")
        self._guesses.add(address, now_s)
        return Entry(refusal="page.wrong_word")

    def visitor(self, ticket: str) -> str | None:
        """Return the seat of a ticket; None after its word was replaced."""
        self._look(time.monotonic())
        seat, _, word = ticket.partition(":")
        return seat if word and self._words.words.get(seat) == word else None

    def account(self, visitor: str) -> Account:
        """Return the account of a seat; raises WrongUsage (BAD_VALUE) if its file cannot be read."""
        return accounts.load(self.folder / "seats" / f"{visitor}.toml")

    def shown(self, visitor: str) -> str:
        """Return the name of the pupil, or that of the seat."""
        return self._classroom.display_names.get(visitor) or visitor

    def robots(self, visitor: str, present: tuple[str, ...]) -> tuple[str, ...]:
        """Return the robots of a seat: its own, which need not be online, then those of the class; for the teacher all."""
        if visitor == TEACHER:
            return present
        return (visitor, *(robot for robot in present if robot in self._classroom.robots))

    def _look(self, now_s: float) -> None:
        """Read the words again if the file has changed; a file that cannot be read changes nothing."""
        if now_s - self._looked_s < LOOK_S:
            return
        self._looked_s = now_s
        stamp = self._stamp()
        if stamp != self._changed_ns:
            with contextlib.suppress(BeatrixError):
                self._words, self._changed_ns = words.read(self.folder), stamp

    def _stamp(self) -> int:
        try:
            return int((self.folder / words.FILE).stat().st_mtime_ns)
        except OSError:
            return 0
