"""All texts of the window, in each of its languages.

A language is one table of templates by key. Widgets use the keys that begin with `label.` and `tip.`; `gui.console.state` uses
most of the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from gui.console.texts.english import ENGLISH
from gui.console.texts.german import GERMAN

LANGUAGES: Final[Mapping[str, Mapping[str, str]]] = {"en": ENGLISH, "de": GERMAN}
"""Templates of each language, by its ISO 639-1 code."""
DEFAULT_LANGUAGE: Final = "en"


class _WithComma(float):
    """A number that is formatted with a decimal comma."""

    __slots__ = ()

    def __format__(self, format_spec: str) -> str:
        return super().__format__(format_spec).replace(".", ",")


class Texts:
    """The catalogue of one language."""

    def __init__(self, code: str) -> None:
        """Choose a language by its code; raises KeyError if there is no such language."""
        self.code = code
        self._templates = LANGUAGES[code]
        self._comma = self._templates["decimal"] == ","

    def __call__(self, key: str, **slots: str | float) -> str:
        """Return the text of a key with its slots filled in; raises KeyError for an unknown key or a missing slot."""
        if self._comma:
            slots = {
                name: _WithComma(value) if isinstance(value, float) else value
                for name, value in slots.items()
            }
        return self._templates[key].format_map(slots)
