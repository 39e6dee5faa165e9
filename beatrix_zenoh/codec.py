"""Messages to bytes and back: the only place that knows msgpack and JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

import msgpack
import msgspec

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import Refused

MSGPACK = "application/msgpack"
JSON = "application/json"
UNREADABLE = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""What decoders raise at bytes that are no message; the last at thousands of brackets."""
LONGEST = 200
"""Characters of a decoder's complaint that are passed on; it may quote what was sent."""
FLOAT32_MAX = 3.4028234663852886e38

M = TypeVar("M", bound=msgspec.Struct)


def fits(number: float) -> bool:
    """A message can hold it: finite, and not too large for single precision."""
    return abs(number) <= FLOAT32_MAX


def encode(message: msgspec.Struct) -> bytes:
    """Bytes of a message in msgpack, floats in single precision."""
    data: bytes = msgpack.packb(msgspec.to_builtins(message), use_single_float=True)
    return data


def encode_json(message: msgspec.Struct) -> bytes:
    """One line of UTF-8 JSON."""
    return msgspec.json.encode(message)


def decode(data: bytes, kind: type[M]) -> M:
    """Read msgpack.

    Raises:
        Refused: BAD_VALUE, naming the field and what is allowed.
    """
    try:
        return _finite(msgspec.msgpack.decode(data, type=kind))
    except UNREADABLE as error:
        raise bad_value(kind, str(error)) from error


def decode_json(data: bytes, kind: type[M]) -> M:
    """Read JSON text; raises as `decode`."""
    try:
        return _finite(msgspec.json.decode(data, type=kind))
    except UNREADABLE as error:
        raise bad_value(kind, str(error)) from error


def from_words(fields: dict[str, object], kind: type[M]) -> M:
    """Build a message from text values ("0.5", "true"); raises as `decode`."""
    try:
        return _finite(msgspec.convert(fields, type=kind, strict=False))
    except msgspec.ValidationError as error:
        raise bad_value(kind, str(error)) from error


def number(data: bytes) -> float:
    """A single finite number, as text or msgpack (the old per-arm topics); raises as `decode`."""
    try:
        value = float(data.decode())
    except (ValueError, UnicodeDecodeError):
        try:
            value = float(msgspec.msgpack.decode(data, type=float))
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise Refused(Reason.BAD_VALUE, f"Expected one number in rad, got {data[:40]!r}.") from error
    if not fits(value):
        raise Refused(Reason.BAD_VALUE, f"Expected a finite number in rad, got {value}.")
    return value


def field_names(data: bytes, *, json: bool) -> frozenset[str]:
    """Top-level field names of an encoded map, empty if it is none: tells two messages apart."""
    try:
        value = msgspec.json.decode(data) if json else msgspec.msgpack.decode(data)
    except UNREADABLE:
        return frozenset()
    return frozenset(map(str, value)) if isinstance(value, dict) else frozenset()


def bad_value(kind: type[msgspec.Struct], what: str) -> Refused:
    """The refusal of a request that cannot be read, listing what the message holds."""
    text = what[:LONGEST].replace(" - at `$.", " - at `").replace(" - at `$`", "")
    return Refused(Reason.BAD_VALUE, f"{kind.__name__}: {text}. It holds: {outline(kind)}.")


def outline(kind: type[msgspec.Struct]) -> str:
    """Fields of a message in words, optional ones in brackets: `position {x, y, z}, [speed …]`."""
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


def _finite(message: M) -> M:
    for path, number in _floats(message, ""):
        if not fits(number):
            raise bad_value(
                type(message), f"Expected a finite number up to 3.4e38, got {number} - at `$.{path}`"
            )
    return message


def _floats(value: object, path: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, float):
        yield path, value
    elif isinstance(value, msgspec.Struct):
        for name in value.__struct_fields__:
            yield from _floats(getattr(value, name), f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _floats(item, f"{path}[{index}]")
