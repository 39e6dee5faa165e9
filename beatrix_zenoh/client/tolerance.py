"""Tolerant decoding of replies and publications of other versions and foreign programs.

Nodes decode requests strictly. A client must not fail because one sender has another version: unknown enum names are
kept, missing or unreadable fields get a zero value, new fields are ignored.
"""

from __future__ import annotations

import enum
import logging
import threading
import types
import typing
from typing import TypeVar, cast

import msgspec

from beatrix_zenoh import codec

LOG = logging.getLogger("beatrix_zenoh.client")
UNKNOWN = "UNKNOWN"
"""Name for a missing enum value."""
SENDERS = 1000
"""Largest number of reported senders; further senders are not reported."""

E = TypeVar("E", bound=enum.Enum)
M = TypeVar("M", bound=msgspec.Struct)


class Undecodable(ValueError):
    """Raised for bytes that are not a map or contain no field of the expected message."""


def decode(data: bytes, kind: type[M]) -> tuple[M, str]:
    """Decode msgpack; return the message and a description of its errors, empty without errors.

    An unknown enum name becomes a value that equals no member of the enum.

    Raises:
        Undecodable: the bytes are not a map, or the map has none of the message's fields.
    """
    try:
        return msgspec.msgpack.decode(data, type=kind), ""
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
    return cast("M", _struct(fields, kind, "", wrong)), f"{kind.__name__} with {', '.join(wrong)}"


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
        return _member(inner, value)
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
        LOG.warning("%s%s: %s", key or "error reply", f" from session {sender}" if sender else "", what)
