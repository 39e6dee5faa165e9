"""Encoding and decoding of messages as msgpack and JSON."""

from __future__ import annotations

import re
from enum import StrEnum
from functools import cache
from typing import Final, TypeVar

import msgpack
import msgspec

from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract._generated.messages import FLOAT32_MAX, Detail, Reason
from beatrix_zenoh.contract.errors import QUOTED, Refused

MSGPACK = "application/msgpack"
JSON = "application/json"
UNREADABLE = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""Errors that decoders raise for bytes that are not a message; RecursionError: thousands of nested brackets."""
LONGEST = 200
"""Largest number of characters of a decoder's error that a refusal repeats, because the error may quote the request."""
_AT: Final = re.compile(r" - at `\$\.?([^`]*)`\s*$")
"""The path of a field at the end of a decoder's error."""
_FLOAT32: Final = re.compile(r"`float` [<>]= -?3\.4\d+e\+38")
"""The bounds of single precision in a decoder's error."""
_FIELD: Final = re.compile(r"(?:unknown|missing required) field `([^`]*)`")

M = TypeVar("M", bound=msgspec.Struct)


def prepare(*kinds: type[msgspec.Struct]) -> None:
    """Let msgspec read the fields of these types, so that later any thread may decode them.

    msgspec 0.22 reads them when it first decodes a type. A second thread that decodes the type meanwhile crashes the
    process (SIGSEGV), because it uses the unfinished description. Call this where the type is defined or imported:
    Python lets one thread at a time execute a module.
    """
    for kind in kinds:
        msgspec.msgpack.Decoder(kind)


prepare(
    *(kind for kind in vars(messages).values() if isinstance(kind, type) and issubclass(kind, msgspec.Struct))
)


def fits(number: float) -> bool:
    """Return whether a number is finite and within the range of single precision."""
    return abs(number) <= FLOAT32_MAX


def encode(message: msgspec.Struct) -> bytes:
    """Encode a message as msgpack, with floats in single precision."""
    data: bytes = msgpack.packb(msgspec.to_builtins(message), use_single_float=True)
    return data


def encode_request(request: msgspec.Struct) -> bytes:
    """Encode a request as msgpack without the fields that have their defaults: an older robot refuses new fields."""
    data = msgspec.to_builtins(request)
    for name, default in _left_out(type(request)):
        if data[name] == default:
            del data[name]
    packed: bytes = msgpack.packb(data, use_single_float=True)
    return packed


@cache  # msgspec takes 0.1 ms to describe the fields of a type
def _left_out(kind: type[msgspec.Struct]) -> tuple[tuple[str, object], ...]:
    """Return the fields of a request that it need not have, with their defaults as they are encoded."""
    fields = (field for field in msgspec.structs.fields(kind) if not field.required)
    # A pose needs an angle.
    return tuple(
        (field.encode_name, msgspec.to_builtins(field.default)) for field in fields if field.name != "yaw"
    )


def encode_json(message: msgspec.Struct) -> bytes:
    """Encode a message as one line of UTF-8 JSON."""
    return msgspec.json.encode(message)


def decode(data: bytes, kind: type[M]) -> M:
    """Decode a message from msgpack; all text of a reply or publication is printable.

    Raises:
        Refused: BAD_VALUE; message and detail contain the wrong field and, if there are any, the allowed values.
    """
    try:
        message = msgspec.msgpack.decode(data, type=kind)
    except UNREADABLE as error:
        raise bad_value(kind, str(error)) from error
    return message if kind.__struct_config__.forbid_unknown_fields else printable.message(message)


def decode_json(data: bytes, kind: type[M]) -> M:
    """Decode a message from JSON text; raises the errors of `decode`."""
    try:
        return msgspec.json.decode(data, type=kind)
    except UNREADABLE as error:
        raise bad_value(kind, str(error)) from error


def from_text(fields: dict[str, object], kind: type[M]) -> M:
    """Build a message from text values ("0.5", "true") and numbers; raises the errors of `decode`."""
    try:
        return msgspec.convert(fields, type=kind, strict=False)
    except msgspec.ValidationError as error:
        raise bad_value(kind, str(error)) from error


def number(data: bytes) -> float:
    """Decode a finite number, sent as text or msgpack to a per-arm topic of 2023; raises the errors of `decode`."""
    try:
        value = float(data.decode("utf-8-sig"))
    except (ValueError, UnicodeDecodeError):
        try:
            value = float(msgspec.msgpack.decode(data, type=float))
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            text = f"Expected one number in rad, got {data[:40]!r}."
            raise Refused(Reason.BAD_VALUE, text, Detail(field="target")) from error
    if not fits(value):
        text = f"Expected a finite number in rad, got {value}."
        raise Refused(Reason.BAD_VALUE, text, Detail(field="target"))
    return value


def field_names(data: bytes, *, json: bool) -> frozenset[str]:
    """Return the top-level field names of an encoded map; empty if the bytes are not a map."""
    try:
        value = msgspec.json.decode(data) if json else msgspec.msgpack.decode(data)
    except UNREADABLE:
        return frozenset()
    return frozenset(map(str, value)) if isinstance(value, dict) else frozenset()


def bad_value(kind: type[msgspec.Struct], what: str) -> Refused:
    """Return the refusal of a message of `kind`; `what` is the error text of msgspec 0.22, read by the patterns above."""
    text = what[:LONGEST].replace(" - at `$.", " - at `").replace(" - at `$`", "")
    text = _FLOAT32.sub("a finite number up to 3.4e38", text)
    at, name = _AT.search(what), _FIELD.search(what)
    path = ".".join(filter(None, (at and at[1], name and name[1])))
    fields = msgspec.structs.fields(kind)
    known = [field.encode_name for field in fields] if name is not None and "." not in path else []
    allowed = f"Its fields are: {outline(kind)}."
    values = next((_values(field.type) for field in fields if field.encode_name == path), [])
    if values and name is None:
        known, allowed = values, f"Allowed are: {', '.join(values)}."
    return Refused(
        Reason.BAD_VALUE,
        f"{kind.__name__}: {text}. {allowed}",
        Detail(field=path[:QUOTED], known=known),
    )


def _values(kind: object) -> list[str]:
    """Return the values of an enumeration; empty for other types."""
    return [member.value for member in kind] if isinstance(kind, type) and issubclass(kind, StrEnum) else []


def outline(kind: type[msgspec.Struct]) -> str:
    """Return the fields of a message as text, optional ones in brackets: `position {x, y, z}, [speed …]`."""
    parts = []
    for field in msgspec.structs.fields(kind):
        inner = _struct_of(field.type)
        text = field.encode_name
        if inner is not None:
            text += " {" + ", ".join(f.encode_name for f in msgspec.structs.fields(inner)) + "}"
        parts.append(text if field.required else f"[{text}]")
    return ", ".join(parts)


def _struct_of(kind: object) -> type[msgspec.Struct] | None:
    for candidate in (kind, *getattr(kind, "__args__", ())):
        if isinstance(candidate, type) and issubclass(candidate, msgspec.Struct):
            return candidate
    return None
