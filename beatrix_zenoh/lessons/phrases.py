"""What checks say besides the figures: texts of `phrases.toml` and errors of the pupil's program, as data until they are shown."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple

import msgspec

from beatrix_zenoh.contract import sentences
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.sentences.templates import Number
from beatrix_zenoh.lesson_files import ENGLISH

FILE = Path(__file__).with_suffix(".toml")


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
