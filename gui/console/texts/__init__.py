"""All texts of the faces, in each of their languages.

A language is a file of templates by key. Widgets use the keys that begin with `label.` and `tip.`; `gui.console.state` uses
most of the others. The sentences of refusals are in the library, except those that name commands or angles of the head.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache, lru_cache
from importlib import resources
from typing import Any, Final

from beatrix_zenoh.contract import sentences
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.sentences.templates import Language, Number, by_key

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
    own, shared = dict(_file(code)["refusals"]), sentences.language(code)
    head = own.pop("head")
    return table, shared._replace(minus=MINUS, head=head, refusals={**shared.refusals, **by_key(own)})


@lru_cache(maxsize=1024, typed=True)  # a view has 150 texts, nearly all as in the view before
def _filled(code: str, key: str, /, **slots: str | float) -> str:
    templates, language = load(code)
    return templates[key].format_map(
        {
            name: Number(value, language) if isinstance(value, float) else value
            for name, value in slots.items()
        }
    )


class Texts:
    """The catalogue of one language."""

    def __init__(self, code: str) -> None:
        """Choose a language by its code; raises KeyError if there is no such language."""
        self.code = code
        _, self._refusals = load(code)
        self.decimal = self._refusals.decimal

    def __call__(self, key: str, **slots: str | float) -> str:
        """Return the text of a key with its slots filled in; raises KeyError for an unknown key or a missing slot."""
        return _filled(self.code, key, **slots)

    def word(self, name: str) -> str:
        """Return the name of a value or group of the contract; the contract's own if this language has none."""
        words: Mapping[str, str] = _file(self.code).get("values", {})
        return words.get(name, name)

    def refusal(self, reason: Reason, detail: Detail | None) -> str:
        """Return the sentence of a refusal."""
        return sentences.render(reason, detail, self._refusals)
