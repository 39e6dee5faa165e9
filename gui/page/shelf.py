"""Programs of pupils as files, one folder for each seat: schools wipe what a browser itself keeps."""

from __future__ import annotations

import contextlib
import re
import time
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.blocks import python
from beatrix_zenoh.blocks.program import BYTES_MAX, WrongProgram, read
from beatrix_zenoh.client.own_gestures import DEVICES
from beatrix_zenoh.contract.errors import BeatrixError
from gui.page.messages import SaveProgram

NAME: Final = re.compile(r"[\w-](?:[\w -]{0,38}[\w-])?")
PROGRAMS_MAX: Final = 50
"""Largest number of programs of a seat."""
VERSIONS_MAX: Final = 10
"""Largest number of earlier versions of a program."""
VERSION_S: Final = 60.0
"""Shortest time between two versions, except those of runs."""
STAMP: Final = "%Y-%m-%d_%H-%M-%S"
SAVES_MAX, SAVE_S = 10, 0.5
"""A page may save this often at once, and then once in this time (s): twice as often as changes alone make it save."""


Sentence = tuple[str, dict[str, str]]
"""Key and slots of a text."""


class NotKept(Exception):
    """A program cannot be kept or opened; `key` is that of the sentence for the user."""

    def __init__(self, key: str, **slots: str) -> None:
        super().__init__(key, slots)
        self.key, self.slots = key, slots


class Shelf:
    """The programs of all seats: `<folder>/<seat>/<name>.json`, earlier versions in `<seat>/versions`."""

    def __init__(self, folder: Path) -> None:
        """Set the folder; it is made when the first program is kept."""
        self.folder = folder

    def seats(self) -> tuple[str, ...]:
        """Return the seats that have programs."""
        with contextlib.suppress(OSError):
            return tuple(sorted(path.name for path in self.folder.iterdir() if path.is_dir()))
        return ()

    def names(self, seat: str) -> tuple[str, ...]:
        """Return the names of a seat's programs."""
        return tuple(sorted((path.stem for path in self._paths(seat)), key=str.casefold))

    def newest(self, seat: str) -> str:
        """Return the program that was open last; empty: there is none."""
        with contextlib.suppress(OSError, ValueError):  # ValueError: there is none
            return max(self._paths(seat), key=lambda path: path.stat().st_mtime).stem
        return ""

    def read(self, seat: str, name: str) -> str:
        """Return a program, JSON, and remember it as the one that was open last; raises NotKept."""
        if name not in self.names(seat):  # so that no name leads to another folder
            raise NotKept("page.program_missing", name=name[:40])
        path = self._path(seat, name)
        try:
            program = files.text(path, BYTES_MAX, "JSON")
            msgspec.json.decode(program, type=dict[str, msgspec.Raw])
        except (OSError, BeatrixError, msgspec.DecodeError, RecursionError):
            raise NotKept(
                "page.program_unreadable", name=name, folder=str(path.parent / "versions")
            ) from None
        with contextlib.suppress(OSError):
            path.touch()
        return program

    def keep(self, seat: str, name: str, program: str, *, ran: bool = False, other: bool = False) -> str:
        """Write a program, and a version of it if it was run, or of the one before it once a minute; raises NotKept.

        Returns its name: an existing one if only its case differs, because some systems do not tell them apart. If it is
        an `other` program, which takes the name of one, that one becomes a version in any case.
        """
        name = unicodedata.normalize("NFC", name).strip()
        if not NAME.fullmatch(name) or DEVICES.fullmatch(name):
            raise NotKept("page.program_name", name=name[:40])
        if len(program.encode(errors="replace")) > BYTES_MAX:
            raise NotKept("page.program_large", name=name)
        names = self.names(seat)
        name = next((one for one in names if one.casefold() == name.casefold()), name)
        if name not in names and len(names) >= PROGRAMS_MAX:
            raise NotKept("page.program_many", folder=str(self.folder / seat))
        path = self._path(seat, name)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            if not ran and path.exists():
                self._add_version(path, path.read_bytes(), 0.0 if other else VERSION_S)
            with files.replace_when_complete(path) as unfinished:
                unfinished.write_text(program, encoding="utf-8", newline="")
            if ran:
                self._add_version(path, program.encode(), 0.0)
        except (OSError, UnicodeEncodeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise NotKept("page.program_not_written", name=name, reason=reason) from None
        return name

    def _add_version(self, path: Path, program: bytes, pause_s: float) -> None:
        """Write an earlier version of a program, unless the newest one is the same or younger than `pause_s`."""
        folder = path.parent / "versions"
        folder.mkdir(exist_ok=True)
        versions = sorted(folder.glob(f"{path.stem}.*.json"))
        if versions:
            newest = versions[-1]
            if time.time() - newest.stat().st_mtime < pause_s or newest.read_bytes() == program:
                return
        with files.replace_when_complete(folder / f"{path.stem}.{time.strftime(STAMP)}.json") as unfinished:
            unfinished.write_bytes(program)
        for version in versions[: 1 - VERSIONS_MAX]:
            version.unlink()

    def _path(self, seat: str, name: str) -> Path:
        return self.folder / seat / f"{name}.json"

    def _paths(self, seat: str) -> Iterator[Path]:
        with contextlib.suppress(OSError):
            for path in (self.folder / seat).glob("*.json"):
                if NAME.fullmatch(path.stem) and path.is_file():
                    yield path


@dataclass(frozen=True)
class ProgramsView:
    """What a page shows of the programs of its seat."""

    names: tuple[str, ...] = ()
    others: tuple[tuple[str, str], ...] = ()
    """seats and names that the teacher may open"""
    python: str = ""
    """the open program as Python"""
    wrong: Sentence | None = None
    """why it cannot run as it is"""
    note: Sentence = ("", {})
    """what became of the last save"""


@dataclass(frozen=True)
class Opened:
    """The program that the page loads; a part of its own, because it changes only when one is opened."""

    name: str = ""
    owner: str = ""
    """the seat whose program the teacher looks at; empty: one of the page's own, which it saves"""
    program: str = ""


class Desk:
    """The programs that one page shows, and the one that is open."""

    def __init__(self, shelf: Shelf, seat: str, *, teacher: bool = False) -> None:
        """Open the program that the seat had open last; a `teacher` may also look at those of other seats."""
        self._shelf, self._seat, self._teacher = shelf, seat, teacher
        self._saves: list[float] = []
        self.view, self.opened = ProgramsView(), Opened()
        self._show()
        if name := shelf.newest(seat):
            self.open(name)

    def save(self, request: SaveProgram) -> None:
        """Keep a program; the page shows when, or why not."""
        if not self.may_save():
            self._show(note=("page.program_too_often", {}))
            return
        program = request.program
        try:
            name = self._shelf.keep(self._seat, request.name, program, ran=request.ran, other=request.opens)
        except NotKept as error:
            self._show(note=(error.key, error.slots))
            return
        if request.opens:
            self.opened = Opened(name, "", program)
        self._show(**_translated(program), note=("page.program_saved", {"time": time.strftime("%H:%M")}))

    def may_save(self) -> bool:
        """Count a save of a program or gesture; return whether it is not one too many."""
        now_s = time.monotonic()
        self._saves = [moment_s for moment_s in self._saves if now_s - moment_s < SAVES_MAX * SAVE_S]
        self._saves.append(now_s)
        return len(self._saves) <= SAVES_MAX

    def open(self, name: str, owner: str = "") -> None:
        """Open a program of this seat; the teacher may look at one of another seat. No name: only list them anew."""
        if not name:
            self._show()
            return
        if owner and not (self._teacher and owner in self._shelf.seats()):
            self._show(note=("page.program_foreign", {}))
            return
        try:
            program = self._shelf.read(owner or self._seat, name)
        except NotKept as error:
            self._show(note=(error.key, error.slots))
        else:
            self.opened = Opened(name, owner, program)
            self._show(**_translated(program), note=("", {}))

    def _show(self, **changes: object) -> None:
        others = [seat for seat in self._shelf.seats() if seat != self._seat] if self._teacher else ()
        listed = tuple((seat, name) for seat in others for name in self._shelf.names(seat))
        self.view = replace(self.view, names=self._shelf.names(self._seat), others=listed, **changes)  # type: ignore[arg-type]


def _translated(program: str) -> dict[str, object]:
    """Return the parts `python` and `wrong` of the view: the program as Python, or why it has none."""
    try:
        return {"python": python.text(read(program)), "wrong": None}
    except WrongProgram as error:
        return {"python": "", "wrong": (f"blocks.{error.key}", {"text": error.message, **error.slots})}
