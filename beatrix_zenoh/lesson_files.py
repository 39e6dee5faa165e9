"""A lesson is a folder of `lessons/library/`: its texts, its programs, its check, and what it says about each figure.

Lessons with `blocks` in lesson.toml suit programs of blocks. One with a start.py, too, has `blocks.md` and `blocks.toml`,
which say with blocks what its page, its hints and the explanations of its figures say with Python.
"""

from __future__ import annotations

import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Annotated, Final, TypeVar

import msgspec

from beatrix_zenoh.contract.errors import bad_value

T = TypeVar("T", bound=msgspec.Struct)
ENGLISH = "en"
LIBRARY = Path(__file__).parent / "lessons/library"
GENERAL = "figures"
"""Name of the file, beside the lessons, with the figures that every lesson has."""
NOT_MEASURED: Final = "not-measured"
"""Reported in place of a figure if a check has judged nothing."""
BRACES: Final = re.compile(r"\{[^}]*\}")
"""A value of a check in a sentence."""


class FigureTexts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is said when a figure is not met; braces name values that the check reports, as in `{count}`."""

    asked: str
    found: str
    means: str
    hint: Annotated[int, msgspec.Meta(ge=0, le=3)] = 0
    """number of the hint that helps; 0: none"""


class _Texts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The contents of `hints.toml`."""

    hints: list[str] = []
    figures: dict[str, FigureTexts] = {}


class _BlockTexts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The contents of `blocks.toml`: hints, and what figures mean, by name; what they ask and find is the same."""

    hints: list[str] = []
    means: dict[str, str] = {}


class LessonFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The contents of `lesson.toml`."""

    title: str
    level: str
    """`S` school from 14, `U` university, `S/U` both"""
    minutes: int
    goal: str
    """one sentence for the pupil"""
    limit_s: float
    """longest time of the pupil's program (s) in a check"""
    version: int = 1
    needs: list[str] = []
    no_turn: str = ""
    """why `beatrix lesson turn` cannot run the program on a robot, and what to do instead; empty: it can"""
    endless: bool = False
    """whether the program runs until Ctrl-C, so that a turn on the robot ends it without an error"""
    blocks: list[str] = []
    """types of the blocks to choose from; empty: the lesson needs Python"""
    title_de: str = ""
    goal_de: str = ""


class Lesson:
    """A lesson; `language` chooses the texts; a lesson whose page is not translated is English as a whole.

    Raises Refused (BAD_VALUE) if a file of the folder is missing or invalid.
    """

    def __init__(self, folder: Path, language: str = ENGLISH) -> None:
        self.folder = folder
        self.language = language if (folder / f"lesson.{language}.md").is_file() else ENGLISH
        self.name = folder.name
        self.number = int(folder.name.split("-")[0].lstrip("b"))
        """that of the lesson whose idea it shares, if it is for blocks only"""
        self.about = _read(folder / "lesson.toml", LessonFile)
        german = self.language == "de"
        self.title = (german and self.about.title_de) or self.about.title
        self.goal = (german and self.about.goal_de) or self.about.goal
        """what the pupil has to reach, in one sentence"""
        self.page = self._translated(folder / "lesson.md")
        self.teacher_page = self._translated(folder / "teacher.md")
        texts = _read(self._translated(folder / "hints.toml"), _Texts)
        self.hints, self._figures = texts.hints, texts.figures
        """the hints, the first to give first"""

    def figure(self, name: str) -> FigureTexts:
        """Return what to say about a figure: of this lesson, or of every lesson."""
        general = _read(self._translated(LIBRARY / f"{GENERAL}.toml"), _Texts)
        return (general.figures | self._figures)[name]

    def _translated(self, path: Path) -> Path:
        translated = path.with_name(f"{path.stem}.{self.language}{path.suffix}")
        return translated if translated.is_file() else path


class BlockLesson(Lesson):
    """A lesson with the texts for pupils who solve it with blocks."""

    def __init__(self, folder: Path, language: str = ENGLISH) -> None:
        super().__init__(folder, language)
        own = _BlockTexts()
        if (folder / "blocks.md").is_file():
            self.page = self._translated(folder / "blocks.md")
            own = _read(self._translated(folder / "blocks.toml"), _BlockTexts)
        general = _read(self._translated(LIBRARY / "blocks.toml"), _BlockTexts)
        self.hints = own.hints or self.hints
        self._means = general.means | own.means

    def figure(self, name: str) -> FigureTexts:
        """As `Lesson.figure`, without words about Python."""
        texts = super().figure(name)
        return msgspec.structs.replace(texts, means=self._means.get(name, texts.means))


def names() -> list[str]:
    """Return the names of all lessons in their order, those for blocks only last."""
    return sorted(path.parent.name for path in LIBRARY.glob("*/lesson.toml"))


def lessons(language: str = ENGLISH) -> list[Lesson]:
    """Return all lessons in Python in their order."""
    return [Lesson(LIBRARY / name, language) for name in names() if (LIBRARY / name / "start.py").is_file()]


def block_lessons(language: str = ENGLISH) -> list[BlockLesson]:
    """Return all lessons that suit blocks, in the order in which their numbers rise."""
    found = (BlockLesson(LIBRARY / name, language) for name in names())
    return sorted((one for one in found if one.about.blocks), key=lambda one: one.number)


def find(number: int, language: str = ENGLISH) -> Lesson:
    """Return a lesson in Python by its number; raises Refused (BAD_VALUE) if there is none."""
    by_number = {one.number: one.name for one in lessons()}
    if number in by_number:
        return Lesson(LIBRARY / by_number[number], language)
    numbers = ", ".join(map(str, by_number))
    raise bad_value(
        f"There is no lesson {number}: choose one of {numbers}. `beatrix lesson list` shows them.",
    )


@cache
def asked(lesson: str, figure: str, language: str = ENGLISH) -> str:
    """Return what a check asks at a figure; values of the check are left out. The name of an unknown figure is returned."""
    if lesson not in names():
        return figure
    try:
        texts = Lesson(LIBRARY / lesson, language).figure(figure)
    except KeyError:  # of another version of BEATRIX
        return figure
    return BRACES.sub("…", texts.asked)


def _read(path: Path, kind: type[T]) -> T:
    try:
        return msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8")), kind)
    except (OSError, ValueError, msgspec.ValidationError) as error:
        raise bad_value(f"{path} cannot be used: {error}.") from error
