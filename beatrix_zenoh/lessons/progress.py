"""What a pupil has done so far: one small file, `progress.json` in the folder `lessons` of the pupil."""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path

import msgspec

from beatrix_zenoh import files
from beatrix_zenoh.contract._generated.messages import LessonState
from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.lesson_files import ENGLISH, NOT_MEASURED, Lesson

FOLDER, FILE = "lessons", "progress.json"
LONGEST = 256 * 1024
"""Largest size of this file (bytes)."""
MOST = 2**16 - 1


class Record(msgspec.Struct, forbid_unknown_fields=True):
    """One lesson."""

    version: int = 1
    """version of the lesson"""
    tries: int = 0
    """checks that have judged the program"""
    hints: list[int] = []
    """numbers of the hints that were shown"""
    figure: str = ""
    """first figure that the last check has found unmet; empty: none"""
    stuck: int = 0
    """checks since one has ended at a figure for the first time"""
    seen: list[str] = []
    """figures at which checks have ended since the last pass"""
    passed: list[str] = []
    """what `sealed` returns for each program that has passed, the newest last"""

    def next_hint(self, lesson: Lesson) -> int:
        """Return the number of the hint to show: of the last figure, then one that was not shown; note that it is."""
        wanted: list[int] = []
        with contextlib.suppress(KeyError):  # a figure of an earlier version
            wanted = [lesson.figure(self.figure).hint] if self.figure else []
        order: list[int] = [
            one for one in (*wanted, *range(1, len(lesson.hints) + 1)) if 0 < one <= len(lesson.hints)
        ]
        fresh = [one for one in order if one not in self.hints]
        self.hints += fresh[:1]
        return (fresh or order)[0]

    def state(self, *, measured: bool = True) -> LessonState:
        """Return what is reported to the teacher: numbers, and the name of a figure.

        measured: whether the last check has judged the program.
        """
        return LessonState(
            version=self.version,
            tries=min(self.tries, MOST),
            hints=len(self.hints),
            figure=self.figure if measured else NOT_MEASURED,
            stuck=min(self.stuck, MOST),
            passed=bool(self.passed),
        )


class ProgressFile(msgspec.Struct, forbid_unknown_fields=True):
    """All lessons by name."""

    language: str = ENGLISH
    lessons: dict[str, Record] = {}


def sealed(lesson: str, sha256: str) -> str:
    """Return the entry of a program that has passed: its hash, and a second one, which no editor adds by accident."""
    return f"{sha256}-{hashlib.sha256(f'{lesson} {sha256}'.encode()).hexdigest()[:16]}"


class Workspace:
    """The folder `lessons`, with a folder for each lesson that was started; it need not exist.

    Entries of `passed` that no check has written count for nothing.

    Raises Refused (BAD_VALUE) if progress.json cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._path = folder / FILE
        try:
            text = files.text(self._path, LONGEST, "JSON") if self._path.exists() else "{}"
            self.progress = msgspec.json.decode(text, type=ProgressFile)
        except (OSError, ValueError) as error:
            raise bad_value(
                f"{self._path} cannot be read: {error}. Delete it; your programs stay."
            ) from error
        for lesson, record in self.progress.lessons.items():
            record.passed = [one for one in record.passed if one == sealed(lesson, one.partition("-")[0])]

    def record(self, lesson: str) -> Record:
        """Return the record of a lesson, an empty one if there is none yet."""
        return self.progress.lessons.setdefault(lesson, Record())

    def programs(self, lesson: str) -> list[Path]:
        """Return the pupil's files of a lesson, the one that was saved last first."""
        found = [self.folder / lesson / name for name in ("start.py", "start.ipynb")]
        return sorted((path for path in found if path.is_file()), key=lambda path: -path.stat().st_mtime)

    def save(self) -> None:
        """Write progress.json; raises Refused (BAD_VALUE) if that is not possible."""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with files.replace_when_complete(self._path) as unfinished:
                unfinished.write_bytes(msgspec.json.format(msgspec.json.encode(self.progress)))
        except OSError as error:
            raise bad_value(
                f"{self._path} cannot be written: {error.strerror or error}. Check its folder.",
            ) from error


def workspace(folder: Path) -> Workspace:
    """Return the folder `lessons` that belongs to a working folder: the one it is in, or the one inside it.

    A working folder is in it if it is that folder, or in the folder of a lesson there: a folder `lessons` further up may
    be that of another pupil.
    """
    for place in (folder, *folder.parents):
        if place.name == FOLDER and (place / FILE).is_file():
            found = Workspace(place)
            if folder == place or folder.relative_to(place).parts[0] in found.progress.lessons:
                return found
    return Workspace(folder / FOLDER)
