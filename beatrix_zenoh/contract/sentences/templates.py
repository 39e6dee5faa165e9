"""The templates of a language, and the words and numbers of a detail that fill them.

Numbers have degrees instead of radians, and enough digits to distinguish a value from its limit.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple, Self

from beatrix_zenoh.contract._generated.messages import Detail, Limit, Reason, Vector3
from beatrix_zenoh.contract.values import in_unit, suffix

Key = tuple[Reason, Limit | None, str]
"""Reason, limit and case of a sentence; `(reason, None, "")` is the general sentence of a reason."""
_LONGEST: Final = 60
"""Number of characters after which a text from a request is cut off."""
_MOST_DECIMALS = 9
_ROUNDING = 1e-5
"""Smallest tolerance, in units of the last digit."""
_SINGLE = 2.0**-23
"""Tolerance as a fraction of a limit: the single precision of a received limit must not change its text."""


class Language(NamedTuple):
    """Templates of one language; their fields are those of `slots_of`."""

    decimal: str
    """decimal sign"""
    minus: str
    """sign of negative numbers"""
    conjunction: str
    """word before the last entry of a list"""
    arms: Mapping[str, str]
    """names of the arms"""
    commands: Mapping[str, str]
    """verbs of the commands to send first"""
    refusals: Mapping[Key, str]
    """what happened, what is allowed and, if it is always the same, what to do"""
    leaves: str
    """when and where a motion leaves the limits"""
    head: str
    """a head orientation that would be accepted"""
    position: str
    """arm angles that would be accepted"""
    speed: str
    """speeds that would be accepted"""
    nothing: str
    """sentence if no alternative was found"""


@cache
def language(code: str) -> Language:
    """Return the sentences of a language, from its file in this folder; `code` as in ISO 639-1."""
    table = tomllib.loads(Path(__file__).with_name(f"{code}.toml").read_text(encoding="utf-8"))
    return Language(refusals=by_key(table.pop("refusals")), **table)


def by_key(table: Mapping[str, str]) -> Mapping[Key, str]:
    """Return sentences by their keys instead of names such as `OUT_OF_REACH TILT goal unfit`."""
    return {_key(name): text for name, text in table.items()}


def _key(name: str) -> Key:
    reason, *words = name.split()
    limit = Limit[words.pop(0)] if words and words[0] in Limit.__members__ else None
    return Reason[reason], limit, " ".join(words)


class Number(float):
    """A number that is formatted with the decimal sign and the minus sign of a language."""

    _language: Language

    def __new__(cls, value: float, language: Language) -> Self:
        """Format `value` as this language does."""
        number = super().__new__(cls, value)
        number._language = language
        return number

    def __format__(self, format_spec: str) -> str:
        return _decimal(super().__format__(format_spec), self._language)


def slots_of(detail: Detail, language: Language) -> dict[str, str]:
    """Return the fields for the templates of a language, as far as the detail has them.

    The fields value, low and high contain their unit, arms the names of the arms. The fields leaves_s, leaves_arms,
    field, known, holder, presser, wait_s and needs are those of `Detail`; yaw, pitch, roll, position and speed are those of the
    alternative.
    """
    slots = _measured(detail, language)
    if detail.arms:
        slots["arms"] = _list([language.arms.get(arm, arm) for arm in detail.arms], language)
    if detail.leaves_s is not None:
        slots["leaves_s"] = _decimal(f"{detail.leaves_s:.2f} s", language)
    if detail.leaves_arms is not None:
        slots["leaves_arms"] = _vector(detail.leaves_arms, "rad", language)
    for name in ("field", "holder", "presser"):
        text: str = getattr(detail, name)
        if text:
            slots[name] = text if len(text) <= _LONGEST else text[:_LONGEST] + "…"
    if detail.known:
        slots["known"] = ", ".join(detail.known)
    if detail.needs:
        slots["needs"] = _list([language.commands.get(name, name) for name in detail.needs], language)
    if detail.wait_s is not None:
        slots["wait_s"] = _decimal(f"{math.ceil(10 * max(0.0, detail.wait_s) - 1e-3) / 10:.1f} s", language)
    return slots | _alternative(detail, language)


def _measured(detail: Detail, language: Language) -> dict[str, str]:
    sign, slots = suffix(detail.unit), {}
    limits: list[tuple[float, str]] = []
    for name, limit, show in (("low", detail.low, least), ("high", detail.high, most)):
        if limit is not None and math.isfinite(limit):
            number = in_unit(limit, detail.unit)
            limits.append((number, show(number) if detail.unit else count(number)))
            slots[name] = _decimal(limits[-1][1] + sign, language)
    if detail.value is not None and math.isfinite(detail.value):
        number = in_unit(detail.value, detail.unit)
        text = apart(number, limits) if detail.unit else count(number)
        slots["value"] = _decimal(text + sign, language)
    return slots


def _alternative(detail: Detail, language: Language) -> dict[str, str]:
    slots: dict[str, str] = {}
    if detail.alternative is None:
        return slots
    head, arms, speed = detail.alternative.head, detail.alternative.arms, detail.alternative.speed
    if head is not None:
        for name in ("yaw", "pitch", "roll"):
            slots[name] = _decimal(f"{math.degrees(getattr(head, name)):z.1f}°", language)
    if arms is not None:
        slots["position"] = _vector(arms, "rad", language)
    if speed is not None:
        equal = speed.x == speed.y == speed.z
        slots["speed"] = (
            _numbers([speed.x], "rad/s", language) if equal else _vector(speed, "rad/s", language)
        )
    return slots


def _vector(value: Vector3, unit: str, language: Language) -> str:
    return _numbers([value.x, value.y, value.z], unit, language)


def _numbers(values: Sequence[float], unit: str, language: Language) -> str:
    """Format a list of numbers, separated by semicolons if the decimal sign is a comma."""
    separator = ", " if language.decimal == "." else "; "
    show = shown if unit == "rad/s" else "{:z.1f}".format
    texts = [show(in_unit(value, unit)) + suffix(unit) for value in values]
    return separator.join(_decimal(text, language) for text in texts)


def _list(words: Sequence[str], language: Language) -> str:
    *first, last = words
    return f"{', '.join(first)}{language.conjunction}{last}" if first else last


def _decimal(text: str, language: Language) -> str:
    return text.replace(".", language.decimal).replace("-", language.minus)


def decimals_of(number: float) -> int:
    """Return the number of decimals, from 1 to 9, that shows at least two significant digits."""
    if not number or not math.isfinite(number) or abs(number) >= 0.95:
        return 1
    return min(_MOST_DECIMALS, 1 - math.floor(math.log10(abs(number) * (1 + _ROUNDING))))


def shown(number: float) -> str:
    """Format a number with `decimals_of` decimals."""
    return f"{number:z.{decimals_of(number)}f}"


def least(number: float) -> str:
    """Format a lower limit, rounded up, so that the shown number is allowed."""
    decimals = decimals_of(number)  # of the rounded number they may be fewer, which would round again
    units = number * 10**decimals
    return f"{math.ceil(units - _tolerance(units)) / 10**decimals:z.{decimals}f}"


def most(number: float) -> str:
    """Format an upper limit, rounded down, so that the shown number is allowed."""
    decimals = decimals_of(number)
    units = number * 10**decimals
    return f"{math.floor(units + _tolerance(units)) / 10**decimals:z.{decimals}f}"


def _tolerance(units: float) -> float:
    """Return the allowed error of a limit; limit and error are in units of the last digit."""
    return max(_ROUNDING, abs(units) * _SINGLE)


def apart(number: float, limits: Iterable[tuple[float, str]]) -> str:
    """Format a refused number with enough decimals that the text is on the same side of every limit as the number.

    Args:
        number: the refused number.
        limits: each limit as a number, and as the text that shows it.
    """
    bounds = [(limit, float(text)) for limit, text in limits]
    for decimals in range(decimals_of(number), _MOST_DECIMALS + 1):
        text = f"{number:z.{decimals}f}"
        if all(number == limit or (float(text) - bound) * (number - limit) > 0 for limit, bound in bounds):
            return text
    return f"{number:z.{_MOST_DECIMALS}f}"


def count(number: float) -> str:
    """Format a number without a unit; a whole number without decimals."""
    return f"{number:.0f}" if number.is_integer() else shown(number)
