"""Text from the network as one printable line of bounded length, so that it cannot forge lines of tables and logs."""

from __future__ import annotations

import re
import types
import typing
from collections.abc import Callable
from functools import cache
from typing import Annotated, Final, TypeVar, cast, get_args

import msgspec

from beatrix_zenoh.contract._generated.messages import Label, Name, Text

ITEMS: Final = 256
"""Largest number of texts or messages in a list; further ones are dropped. Lists of numbers may be longer."""
_OTHER: Final = re.compile(r"[^a-z0-9-]")

M = TypeVar("M", bound=msgspec.Struct)


@cache
def longest(kind: object) -> int:
    """Return the largest number of characters of a text of this kind: Name, Label or Text."""
    found: int = get_args(kind)[1].extra["longest"]
    return found


def name(text: str) -> str:
    """Return a name of a robot or seat, cut if it is too long, with `?` for each invalid character."""
    return _OTHER.sub("?", text[: longest(Name)])


def label(text: str) -> str:
    """Return a technical text as one line."""
    return line(text, longest(Label))


def line(text: str, most: int = longest(Text)) -> str:
    """Return a text as one line of at most `most` characters.

    Line feeds, tabs and unusual spaces become spaces. `?` replaces other characters that are not printable: escape
    sequences, and marks that reverse the direction of writing.
    """
    if len(text) > most:
        text = text[: most - 1] + "…"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else " " if c.isspace() else "?" for c in text)


_TEXTS: Final[dict[object, Callable[[str], str]]] = {Name: name, Label: label, Text: line}


def message(decoded: M) -> M:
    """Return a message in which all texts are printable; the same object if its type contains no text.

    Names consist of their alphabet and `?`; other text is one line. Texts and lists of them have bounded lengths.
    """
    return cast("M", _printable(type(decoded), decoded))


def _printable(kind: object, value: object) -> object:
    clean = _cleaner(kind)
    return value if clean is None or value is None else clean(value)


def _bare(kind: object) -> object:
    """Return an annotated type without how its value is shown: the type of its text, or without annotations."""
    base, *said = get_args(kind)
    return next((text for text in _TEXTS if get_args(text) == (base, said[0])), base)


@cache
def _cleaner(kind: object) -> Callable[[object], object] | None:
    """Return the function that makes the text of values of a type printable; None if they contain no text."""
    if kind in _TEXTS:
        return cast("Callable[[object], object]", _TEXTS[kind])
    if typing.get_origin(kind) is Annotated:
        return _cleaner(_bare(kind))
    if typing.get_origin(kind) in (types.UnionType, typing.Union):
        return _cleaner(next(one for one in get_args(kind) if one is not type(None)))
    if typing.get_origin(kind) is list:
        (item,) = get_args(kind)
        clean = _cleaner(item)
        return clean and (lambda items: [clean(one) for one in cast("list[object]", items)[:ITEMS]])
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        kinds = {field.name: field.type for field in msgspec.structs.fields(kind)}
        cleaners = [(field, _cleaner(one)) for field, one in kinds.items()]
        fields = [(field, clean) for field, clean in cleaners if clean is not None]
        return (lambda part: _struct(cast("msgspec.Struct", part), fields)) if fields else None
    return None


def _struct(part: msgspec.Struct, fields: list[tuple[str, Callable[[object], object]]]) -> msgspec.Struct:
    """Return a message with printable text in these fields; the same object if no text changes."""
    changed = {}
    for field, clean in fields:
        value = getattr(part, field)
        if value is not None and (printed := clean(value)) is not value:
            changed[field] = printed
    return msgspec.structs.replace(part, **changed) if changed else part
