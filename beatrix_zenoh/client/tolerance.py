"""Tolerant decoding of replies and publications of other versions and foreign programs.

Nodes decode requests strictly. A client must not fail because one sender has another version: unknown enum names are
kept, missing or unreadable fields get a zero value, new fields are ignored. Text becomes printable here, so that no
program that shows a message has to do so ([why](docs/explanation/decisions/0048-text-is-made-printable-where-it-is-decoded.md)).
"""

from __future__ import annotations

import enum
import logging
import threading
import types
import typing
from collections.abc import Callable
from functools import cache
from typing import TypeVar, cast

import msgspec

from beatrix_zenoh import printable
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Label, Name, Text

LOG = logging.getLogger("beatrix_zenoh.client")
UNKNOWN = "UNKNOWN"
"""Name for a missing enum value."""
SENDERS = 1000
"""Largest number of reported senders; further senders are not reported."""

ITEMS = 256
"""Largest number of texts or messages in a list; further ones are dropped. Lists of numbers may be longer."""
ERRORS = 5
"""Largest number of errors of a message that are reported."""
TEXTS: dict[object, Callable[[str], str]] = {
    Name: printable.name,
    Label: printable.label,
    Text: printable.line,
}

E = TypeVar("E", bound=enum.Enum)
M = TypeVar("M", bound=msgspec.Struct)


class Undecodable(ValueError):
    """Raised for bytes that are not a map or contain no field of the expected message."""


def decode(data: bytes, kind: type[M]) -> tuple[M, str]:
    """Decode msgpack; return the message and a description of its errors, empty without errors.

    An unknown enum name becomes a value that equals no member of the enum. Names consist of their alphabet and `?`,
    other text is one printable line, and both and lists of them have bounded lengths.

    Raises:
        Undecodable: the bytes are not a map, or the map has none of the message's fields.
    """
    try:
        return cast("M", _clean(kind, msgspec.msgpack.decode(data, type=kind))), ""
    except codec.UNREADABLE:
        pass
    try:
        fields = msgspec.msgpack.decode(data)
    except codec.UNREADABLE as error:
        raise Undecodable(f"its {len(data)} bytes are not msgpack") from error
    wrong: list[str] = []
    known = {field.encode_name for field in msgspec.structs.fields(kind)}
    if not isinstance(fields, dict) or not known & fields.keys():
        raise Undecodable(f"it has no field of {kind.__name__}")
    message = cast("M", _clean(kind, _struct(fields, kind, "", wrong)))
    return message, f"{kind.__name__} with {', '.join(wrong[:ERRORS])}"


def _clean(kind: object, value: object) -> object:
    """Return a decoded value with printable text; the same object if it has no text to change."""
    clean = _cleaner(kind)
    return value if clean is None or value is None else clean(value)


@cache
def _cleaner(kind: object) -> Callable[[object], object] | None:
    """Return the function that makes the text of values of a type printable; None if they contain no text."""
    if kind in TEXTS:
        return cast("Callable[[object], object]", TEXTS[kind])
    if typing.get_origin(kind) in (types.UnionType, typing.Union):
        return _cleaner(next(one for one in typing.get_args(kind) if one is not type(None)))
    if typing.get_origin(kind) is list:
        (item,) = typing.get_args(kind)
        clean = _cleaner(item)
        return clean and (lambda items: [clean(one) for one in cast("list[object]", items)[:ITEMS]])
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        kinds = {field.name: field.type for field in msgspec.structs.fields(kind)}
        fields = [(name, one) for name, one in kinds.items() if _cleaner(one) is not None]
        return (lambda message: _clean_struct(cast("msgspec.Struct", message), fields)) if fields else None
    return None


def _clean_struct(message: msgspec.Struct, fields: list[tuple[str, object]]) -> msgspec.Struct:
    """Return a message with printable text in these fields, each with its type."""
    values = {name: _clean(kind, getattr(message, name)) for name, kind in fields}
    return msgspec.structs.replace(message, **values)


def _struct(fields: object, kind: type[msgspec.Struct], path: str, wrong: list[str]) -> msgspec.Struct:
    given = fields if isinstance(fields, dict) else {}
    values = {}
    for field in msgspec.structs.fields(kind):
        name = f"{path}{field.encode_name}"
        if field.encode_name in given:
            values[field.name] = _value(given[field.encode_name], field.type, name, wrong)
        elif field.required:
            wrong.append(f"no {name}")
            values[field.name] = _zero(field.type)
    return kind(**values)


def _value(value: object, kind: object, name: str, wrong: list[str]) -> object:
    try:
        return msgspec.convert(value, kind)
    except msgspec.ValidationError:
        pass
    inner, item = _taken_apart(kind)
    if issubclass(inner, enum.Enum) and isinstance(value, str):
        wrong.append(f"{name} {value[: codec.LONGEST]!r}")
        return _member(inner, printable.label(value))
    if issubclass(inner, msgspec.Struct) and isinstance(value, dict):
        return _struct(value, inner, f"{name}.", wrong)
    if inner is list and isinstance(value, list):
        return [_value(one, item, name, wrong) for one in value]
    wrong.append(f"unreadable {name}")
    return _zero(kind)


def _taken_apart(kind: object) -> tuple[type, object]:
    """Return a type without Annotated and `| None`, and the type of its items, which is None unless it is a list."""
    origin, args = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Annotated:
        return _taken_apart(args[0])
    if origin in (types.UnionType, typing.Union):
        return _taken_apart(next(one for one in args if one is not type(None)))
    if origin is list:
        return list, args[0]
    return cast("type", kind), None


def _zero(kind: object) -> object:
    if type(None) in typing.get_args(kind):
        return None
    inner, _ = _taken_apart(kind)
    if issubclass(inner, enum.Enum):
        return _member(inner, UNKNOWN)
    if issubclass(inner, msgspec.Struct):
        return _struct({}, inner, "", [])
    return inner()


def _member(kind: type[E], name: str) -> E:
    """Return a value of a text enum that has this name and equals none of the members."""
    member = cast("E", str.__new__(cast("type[str]", kind), name))
    member._name_ = member._value_ = name
    return member


class Reporter:
    """Logs errors of messages once for each sender, or for each key if the sender is unknown."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._reported: set[str] = set()

    def report(self, sender: str, key: str, what: str) -> None:
        """Log a warning; `sender` is a Zenoh session, empty if unknown."""
        with self._lock:
            if (sender or key) in self._reported or len(self._reported) >= SENDERS:
                return
            self._reported.add(sender or key)
        source = f"{key or 'error reply'}{f' from session {sender}' if sender else ''}"
        LOG.warning("%s", printable.line(f"{source}: {what}"))
