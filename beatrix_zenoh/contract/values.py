"""The values in a message as people read them: named, in groups, angles in degrees; as their fields say."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from enum import Enum
from functools import cache
from typing import NamedTuple, get_type_hints

from msgspec import Struct

from beatrix_zenoh.contract.rows import ValueRow

DEGREES = {"rad": "°", "rad/s": "°/s", "rad/s2": "°/s2"}
"""Units that people do not read, and those that they do."""
ATTACHED = ("", "°")
"""Beginnings of units that stand beside their number without a space."""


class Value(NamedTuple):
    """One value of a message."""

    field: str
    """its place in the message: `board.port`, `cameras.left.hz`"""
    title: str
    group: str
    value: object
    """bool, number, text, or list of texts; angles in degrees"""
    row: ValueRow

    @property
    def unit(self) -> str:
        """The unit that people read."""
        return DEGREES.get(self.row.unit, self.row.unit)

    @property
    def number(self) -> float:
        """The value as a number; NaN if it is none."""
        return float(self.value) if isinstance(self.value, int | float) else math.nan

    def text(self, decimal: str = ".") -> str:
        """Return the value with its unit; `-` if there is none."""
        if isinstance(self.value, bool):
            return "yes" if self.value else "no"
        if isinstance(self.value, list):
            return "; ".join(map(str, self.value)) or "-"
        if isinstance(self.value, float):
            number = f"{self.value:z.{self.row.decimals}f}".replace(".", decimal)
        else:
            number = "" if self.value is None else str(self.value)
        return f"{number}{suffix(self.row.unit)}" if number else "-"


def suffix(unit: str) -> str:
    """Return what stands after a number in a unit of a message: the unit that people read, after a space if it needs one."""
    shown = DEGREES.get(unit, unit)
    return shown if shown[:1] in ATTACHED else f" {shown}"


def in_unit(value: float, unit: str) -> float:
    """Convert a number from a unit of a message to the one that people read: degrees for radians."""
    return math.degrees(value) if unit in DEGREES else value


@cache
def rows(kind: type[Struct]) -> Mapping[str, ValueRow]:
    """Return how the fields of a message are shown."""
    hints = get_type_hints(kind, include_extras=True)
    return {field: _row(field, getattr(hints[field], "__metadata__", ())) for field in kind.__struct_fields__}


def _row(field: str, said: Iterable[object]) -> ValueRow:
    row = next((one for one in said if isinstance(one, ValueRow)), ValueRow())
    return row._replace(title=row.title or _words(field))


def _words(field: str) -> str:
    """Return the name of a field as words, without its unit."""
    return field.removesuffix("_ns").removesuffix("_s").replace("_", " ")


def values(message: Struct, group: str = "", path: str = "", unit: str = "") -> Iterator[Value]:
    """Yield the values of a message, and of the messages in it.

    Args:
        message: a message that a robot publishes.
        group: group of all values; empty: those of the table.
        path: beginning of their fields.
        unit: unit of values that have none in the table, as the three of a vector.
    """
    for field, row in rows(type(message)).items():
        value, place = getattr(message, field), f"{path}{field}"
        unit_here = row.unit or unit
        if isinstance(value, Struct):
            yield from values(value, group or row.group or row.title, f"{place}.", unit_here)
        elif isinstance(value, list) and value and isinstance(value[0], Struct):
            for one in value:
                name = getattr(one, one.__struct_fields__[0])
                parts = values(one, row.group or f"{row.title} {name}", f"{place}.{name}.")
                yield from itertools.islice(parts, 0 if row.group else 1, None)  # the group has the name
        else:
            number = in_unit(value, unit_here) if isinstance(value, float) else value
            plain = number.value if isinstance(number, Enum) else number
            alone = row.title if value in (None, []) else ""  # a message that is missing
            shown = row if row.unit == unit_here else row._replace(unit=unit_here)
            yield Value(place, row.title, group or row.group or alone, plain, shown)


def grouped(message: Struct) -> dict[str, list[Value]]:
    """Return the values of a message by group, in the order of the contract."""
    groups: dict[str, list[Value]] = {}
    for value in values(message):
        groups.setdefault(value.group, []).append(value)
    return groups


def lines(
    message: Struct, without: tuple[str, ...] = (), word: Callable[[str], str] = str, decimal: str = "."
) -> dict[str, str]:
    """Return one line for each group, without values that are empty or 0.

    Args:
        message: as in `values`.
        without: groups to leave out.
        word: translates a title, a group, or `not`.
        decimal: the decimal separator.
    """
    found = {}
    for group, members in grouped(message).items():
        parts = []
        for one in members:
            if isinstance(one.value, bool):
                parts.append(word(one.title) if one.value else f"{word('not')} {word(one.title)}")
            elif one.value not in ("", 0, None, []):
                parts.append(f"{word(one.title)} {one.text(decimal)}")
        if parts and group not in without:
            found[group] = ", ".join(parts)
    return found


def as_data(message: Struct, unit: str = "") -> dict[str, object]:
    """Return a message as data for JSON: angles are in degrees, under the name of their field with `_deg` or `_deg_s`."""
    found: dict[str, object] = {}
    for field, row in rows(type(message)).items():
        value, unit_here = getattr(message, field), row.unit or unit
        if isinstance(value, float) and unit_here in DEGREES:
            found[f"{field}_{unit_here.replace('rad', 'deg').replace('/', '_')}"] = (
                round(math.degrees(value), 3) + 0.0
            )
        elif isinstance(value, Struct):
            found[field] = as_data(value, unit_here)
        elif isinstance(value, list):
            found[field] = [as_data(one) if isinstance(one, Struct) else one for one in value]
        else:
            found[field] = value
    return found
