"""All texts of the faces, in each of their languages.

A language is a file of templates by key. Widgets use the keys that begin with `label.` and `tip.`; `gui.console.state` uses
most of the others. The sentences of refusals are in the library in English, except those that name commands or angles of
the head, and in the file of every other language.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any, Final

from beatrix_zenoh.contract import sentences
from beatrix_zenoh.contract._generated.messages import Detail, Limit, Reason
from beatrix_zenoh.contract.sentences.english import ENGLISH
from beatrix_zenoh.contract.sentences.templates import Key, Language

LANGUAGES: Final = ("en", "de")
"""ISO 639-1 codes."""
DEFAULT_LANGUAGE: Final = "en"
MINUS: Final = "−"
"""U+2212, as wide as the plus sign; commands and programs have a hyphen, because they are copied."""


@cache
def _file(code: str) -> Mapping[str, Any]:
    return tomllib.loads(resources.files(__name__).joinpath(f"{code}.toml").read_text(encoding="utf-8"))


@cache
def load(code: str) -> tuple[Mapping[str, str], Language]:
    """Return the templates of a language by key, and its sentences of refusals; raises KeyError if there are none."""
    if code not in LANGUAGES:
        raise KeyError(code)
    table = {name: text for name, text in _file(code).items() if isinstance(text, str)}
    refusals = dict(_file(code)["refusals"])
    by_key = {_key(name): text for name, text in refusals.pop("sentences").items()}
    if code == DEFAULT_LANGUAGE:
        return table, ENGLISH._replace(minus=MINUS, refusals={**ENGLISH.refusals, **by_key}, **refusals)
    return table, Language(table["decimal"], MINUS, refusals=by_key, **refusals)


def _key(name: str) -> Key:
    """Return reason, limit and case of a sentence, for example of `OUT_OF_REACH TILT goal unfit`."""
    reason, *words = name.split()
    limit = Limit[words.pop(0)] if words and words[0] in Limit.__members__ else None
    return Reason[reason], limit, " ".join(words)


class _WithPoint(float):
    """A number that is formatted with a minus sign instead of a hyphen."""

    __slots__ = ()

    def __format__(self, format_spec: str) -> str:
        return super().__format__(format_spec).replace("-", MINUS)


class _WithComma(_WithPoint):
    """A number that is also formatted with a decimal comma."""

    __slots__ = ()

    def __format__(self, format_spec: str) -> str:
        return super().__format__(format_spec).replace(".", ",")


class Texts:
    """The catalogue of one language."""

    def __init__(self, code: str) -> None:
        """Choose a language by its code; raises KeyError if there is no such language."""
        self.code = code
        self._templates, self._refusals = load(code)
        self.decimal = self._templates["decimal"]
        self._number = _WithComma if self.decimal == "," else _WithPoint

    def __call__(self, key: str, **slots: str | float) -> str:
        """Return the text of a key with its slots filled in; raises KeyError for an unknown key or a missing slot."""
        shown = {
            name: self._number(value) if isinstance(value, float) else value for name, value in slots.items()
        }
        return self._templates[key].format_map(shown)

    def word(self, name: str) -> str:
        """Return the name of a value or group of the contract; the contract's own if this language has none."""
        words: Mapping[str, str] = _file(self.code).get("values", {})
        return words.get(name, name)

    def refusal(self, reason: Reason, detail: Detail | None) -> str:
        """Return the sentence of a refusal."""
        return sentences.render(reason, detail, self._refusals)
