"""Numbers in sentences: degrees instead of radians, and enough digits to distinguish a value from its limit."""

from __future__ import annotations

import math
from collections.abc import Iterable

_MOST_DECIMALS = 9
_ROUNDING = 1e-5
"""Smallest tolerance, in units of the last digit."""
_SINGLE = 2.0**-23
"""Tolerance as a fraction of a limit: the single precision of a received limit must not change its text."""


def in_unit(value: float, unit: str) -> float:
    """Convert a value from the unit of a message to the unit of a sentence: degrees for radians."""
    return math.degrees(value) if unit.startswith("rad") else value


def symbol(unit: str) -> str:
    """Return the symbol after a number, for a unit of a message (rad, rad/s, s or empty)."""
    return {"rad": "°", "rad/s": "°/s", "s": " s"}.get(unit, f" {unit}" if unit else "")


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
    scale = 10 ** decimals_of(number)
    return shown(math.ceil(number * scale - _tolerance(number * scale)) / scale)


def most(number: float) -> str:
    """Format an upper limit, rounded down, so that the shown number is allowed."""
    scale = 10 ** decimals_of(number)
    return shown(math.floor(number * scale + _tolerance(number * scale)) / scale)


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
