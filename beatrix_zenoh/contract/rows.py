"""The types of the rows of the generated tables: keys, words, codes, values and frames; and what is read by them."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Mapping
from enum import IntEnum, StrEnum
from functools import cache, lru_cache
from itertools import islice
from typing import Annotated, Any, ClassVar, NamedTuple, Self, get_origin, get_type_hints

from msgspec import Struct
from msgspec.structs import astuple, fields


class KeyRow(NamedTuple):
    """One row of keys.toml; its purpose is in KEY_TEXT. `keys.stop("bea", "hw", "ana")` is a key with these names."""

    key: str
    payload: str
    reply: str
    session: str
    """Traffic class of the session that answers or subscribes."""
    priority: str = "data"
    kind: str = "query"
    publish: str = "control"
    """Traffic class of the session that publishes, if the row is a publication."""
    rate_hz: int = 0
    """Publications per second; 0: not at a constant rate."""

    @property
    def sides(self) -> tuple[str, ...]:
        """Sides whose robots have this key."""
        return ("sim",) if "/sim/" in self.key else ("hw", "sim")

    def __call__(self, *names: str) -> str:
        """Return the key with these names, or `*`, in place of its fields; raises ValueError for too few or many."""
        return self.key.format_map(dict(zip(_fields(self.key), names, strict=True)))


def stream(
    key: str,
    payload: str,
    reply: str = "",
    priority: str = "data",
    publish: str = "control",
    rate_hz: int = 0,
) -> KeyRow:
    """Return the row of messages that are published, and of which a query returns the newest; `reply`: several."""
    kind = "publication and query"
    return KeyRow(key, payload, reply or payload, "queries", priority, kind, publish, rate_hz)


def media(key: str, payload: str, rate_hz: int = 0) -> KeyRow:
    """Return the row of pictures or sound, which a robot publishes."""
    return KeyRow(key, payload, "", "media", "data_low", "publication", "media", rate_hz)


@cache
def _fields(pattern: str) -> list[str]:
    return re.findall(r"{(\w+)}", pattern)


class Parts(NamedTuple):
    """The names in a key; a name that its row does not contain is empty."""

    row: str
    """Name of the row in KEYS."""
    robot: str = ""
    side: str = ""
    who: str = ""
    eye: str = ""
    arm: str = ""
    session: str = ""
    lesson: str = ""
    gesture: str = ""


def parser(rows: Mapping[str, KeyRow], name: re.Pattern[str]) -> Callable[[str], Parts | None]:
    """Return a function that returns the row of a key and the names in it, which may be `*`.

    It returns None if the key matches no row, or contains an invalid name of a robot, side or seat. `name` is the
    pattern of names of robots and seats.
    """
    chunks = {"robot": name.pattern, "who": name.pattern, "side": "hw|sim"}

    def field(match: re.Match[str]) -> str:
        return rf"(?P<{match[1]}>\*|{chunks.get(match[1], '[^/]+')})"

    patterns = {row_name: re.compile(re.sub(r"{(\w+)}", field, row.key)) for row_name, row in rows.items()}

    @lru_cache(maxsize=256)  # thirty robots have 200 keys; those of sessions come once
    def parse(key: str) -> Parts | None:
        for row_name, pattern in patterns.items():
            if match := pattern.fullmatch(key):
                found = Parts(row_name, **match.groupdict())
                return found._replace(side="sim") if found.robot and not found.side else found
        return None

    return parse


class Word(StrEnum):
    """A word of messages with the sentence that explains it to users."""

    _value_: str
    text: str

    def __new__(cls, word: str, text: str = "") -> Self:
        """Make a word; only the class itself gives a text."""
        made = str.__new__(cls, word)
        made._value_, made.text = word, text
        return made


class Code(IntEnum):
    """A code of the serial link with its text, and the reason that programs give for it, if it is a refusal."""

    text: str
    reason: Word | None

    def __new__(cls, code: int, text: str = "", reason: Word | None = None) -> Self:
        """Make a code; only the class itself gives text and reason."""
        made = int.__new__(cls, code)
        made._value_, made.text, made.reason = code, text, reason
        return made


class Range(NamedTuple):
    """Range of a field in a robot file; a bound is infinite if another value or the firmware limits the field."""

    low: float
    high: float
    unit: str


def ranges(robot: type[Struct]) -> dict[str, dict[str, Range]]:
    """Return the ranges in the annotations of a robot's fields, by table."""
    annotations = {field.name: get_type_hints(field.type, include_extras=True) for field in fields(robot)}
    return {
        table: {name: kind.__metadata__[0] for name, kind in kinds.items() if get_origin(kind) is Annotated}
        for table, kinds in annotations.items()
    }


class ValueRow(NamedTuple):
    """One field of a message that a robot publishes: how programs show its value."""

    title: str = ""
    """Name of the value; empty: the words of the field."""
    unit: str = ""
    group: str = ""
    """Values of one group are shown together; empty: none."""
    decimals: int = 1
    """Decimals in the unit that people read."""
    on_change: bool = True
    """Whether a change of this value alone is published at once: not of clocks, rates and the physics."""


class Frame(Struct, frozen=True):
    """The payload of a frame."""

    layout: ClassVar[struct.Struct]
    """The fields without a text of any length, which may follow them."""
    counts: ClassVar[tuple[int, ...]]
    """How many numbers each of these fields has."""

    def pack(self) -> bytes:
        """Return the payload, without type, seq and checksum."""
        parts: list[Any] = []
        for value in astuple(self):
            parts.extend(value if isinstance(value, tuple) else (value,))
        fixed = sum(self.counts)
        return self.layout.pack(*parts[:fixed]) + b"".join(parts[fixed:])

    @classmethod
    def unpack(cls, payload: bytes) -> Self:
        """Return the fields of a payload; raises struct.error or TypeError if its length is wrong."""
        fixed, text = payload[: cls.layout.size], payload[cls.layout.size :]
        parts = iter(cls.layout.unpack(fixed))
        values = [next(parts) if count == 1 else tuple(islice(parts, count)) for count in cls.counts]
        return cls(*values, *([text] if text else []))
