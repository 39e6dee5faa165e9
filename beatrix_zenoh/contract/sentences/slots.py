"""The words and numbers of a detail for the fields of templates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from beatrix_zenoh.contract._generated.messages import Detail, Vector3
from beatrix_zenoh.contract.sentences import figures
from beatrix_zenoh.contract.sentences.language import Language

_LONGEST: Final = 60
"""Number of characters after which a text from a request is cut off."""


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
    sign, slots = figures.symbol(detail.unit), {}
    limits: list[tuple[float, str]] = []
    for name, limit, show in (("low", detail.low, figures.least), ("high", detail.high, figures.most)):
        if limit is not None and math.isfinite(limit):
            number = figures.in_unit(limit, detail.unit)
            limits.append((number, show(number) if detail.unit else figures.count(number)))
            slots[name] = _decimal(limits[-1][1] + sign, language)
    if detail.value is not None and math.isfinite(detail.value):
        number = figures.in_unit(detail.value, detail.unit)
        text = figures.apart(number, limits) if detail.unit else figures.count(number)
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
    show = figures.shown if unit == "rad/s" else "{:z.1f}".format
    texts = [show(figures.in_unit(value, unit)) + figures.symbol(unit) for value in values]
    return separator.join(_decimal(text, language) for text in texts)


def _list(words: Sequence[str], language: Language) -> str:
    *first, last = words
    return f"{', '.join(first)}{language.conjunction}{last}" if first else last


def _decimal(text: str, language: Language) -> str:
    return text.replace(".", language.decimal)
