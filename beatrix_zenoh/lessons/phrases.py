"""What checks say besides the figures, and how they end early.

Texts of `phrases.toml` and errors of the pupil's program are data until they are shown.
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from beatrix_zenoh.contract import sentences
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.sentences.templates import Number
from beatrix_zenoh.lesson_files import ENGLISH

if TYPE_CHECKING:
    from beatrix_zenoh.lessons.measures import HeadCurves
    from beatrix_zenoh.lessons.picture import Panel

FILE = Path(__file__).with_suffix(".toml")
EVERY_S = 10.0
"""Time (s) between two sentences about a check that takes long."""


class Phrase(NamedTuple):
    """A text by its key in `phrases.toml`; the values fill its braces, and may be phrases and errors themselves."""

    key: str
    values: dict[str, object]


class ErrorData(msgspec.Struct, frozen=True):
    """An error that has ended the pupil's program; one of BEATRIX has a reason."""

    message: str
    kind: str = ""
    """its class; empty: the message names it"""
    reason: Reason | None = None
    detail: Detail | None = None

    @property
    def unnamed(self) -> ErrorData:
        """The error without its class."""
        return msgspec.structs.replace(self, kind="")

    def __str__(self) -> str:
        """Return the error as Python prints it."""
        return f"{self.kind}: {self.message}" if self.kind else self.message


def phrase(key: str, **values: object) -> Phrase:
    """Return a phrase with its values."""
    return Phrase(key, values)


def shown(value: object) -> Phrase | str:
    """Return what a function has returned as a pupil knows it, at most 60 characters of it."""
    if value is None:
        return phrase("nothing")
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def error_data(error: BaseException) -> ErrorData:
    """Return an error as data."""
    if isinstance(error, BeatrixError):
        return msgspec.convert(error.data, ErrorData)
    return ErrorData(str(error), type(error).__name__)


def said(value: object, language: str = ENGLISH) -> object:
    """Return a value of a sentence in a language: phrases and errors become texts, other values stay as they are."""
    if isinstance(value, Phrase):
        numbers = sentences.language(language)
        values = {
            name: Number(one, numbers) if isinstance(one, float) else said(one, language)
            for name, one in value.values.items()
        }
        return phrases()[value.key][language].format_map(values)
    if not isinstance(value, ErrorData):
        return value
    text = str(value)
    if value.reason is not None:
        english = sentences.render(value.reason, value.detail)
        if text.endswith(english):  # otherwise the program that raised it has written the message
            own = sentences.render(value.reason, value.detail, sentences.language(language))
            return text.removesuffix(english) + own
    return text


@cache
def phrases() -> dict[str, dict[str, str]]:
    """Return the templates of all phrases, by language."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


class Unmet(Exception):
    """A figure is not met; `values` fill the sentences of hints.toml, and may be phrases."""

    def __init__(self, figure: str, **values: object) -> None:
        super().__init__(figure)
        self.figure, self.values = figure, values
        self.ended = False
        """whether the program had ended by itself before"""


class Checked:
    """What each check has: figures to require, and why one that is not met may be no fault of the program."""

    doubt: Phrase | None = None
    """why a figure that is not met may be the fault of this computer; None: it was fast enough"""
    cores: float = 0.0
    """part of a core that the last observed program has used; 0 if the system does not tell"""
    draw: Callable[[Mapping[str, HeadCurves]], Sequence[Panel]] = staticmethod(lambda _: ())
    """set by a check: returns the picture of a run from what each robot did"""
    panels: Sequence[Panel] = ()
    """the picture of what was asked and done; empty: none"""

    @staticmethod
    def require(figure: str, met: bool, **values: object) -> None:  # noqa: FBT001 - reads as a sentence
        """End the check with this figure of hints.toml unless it is met; `values` fill its sentences."""
        if not met:
            raise Unmet(figure, **values)


class NotMeasurable(Exception):
    """The check cannot judge the program; `why` says why, and what to do."""

    def __init__(self, why: Phrase) -> None:
        super().__init__(said(why))
        self.why = why


def busy(why: Phrase | str) -> NotMeasurable:
    """Return the error of a computer that was too slow; `why` is a sentence with what was measured."""
    return NotMeasurable(phrase("busy", why=why))


Tell = Callable[[Phrase], None]


class Still:
    """Says every EVERY_S what is going on, with the seconds that are left, or that the caller gives."""

    def __init__(self, tell: Tell, key: str, limit_s: float = 0.0, **values: object) -> None:
        """Prepare a phrase that needs `seconds` and these values."""
        self._tell, self._key, self._values = tell, key, values
        self._next_s = time.monotonic() + EVERY_S
        self._end_s = time.monotonic() + limit_s

    def look(self, seconds: float | None = None) -> None:
        """Say it if it is due; None: with the seconds that are left of the limit."""
        now_s = time.monotonic()
        if now_s >= self._next_s:
            self._next_s = now_s + EVERY_S
            left = self._end_s - now_s if seconds is None else seconds
            self._tell(phrase(self._key, seconds=left, **self._values))
