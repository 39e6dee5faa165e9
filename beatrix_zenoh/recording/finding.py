"""A finding about the cause of differences, as data and as a sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum


class Cause(StrEnum):
    """The cause of differences."""

    STOOD_STILL = "stood still"
    NOT_ASKED = "not asked"
    STOPPED = "stopped"
    BEGAN_APART = "began apart"
    EXCHANGED = "exchanged"
    REVERSED = "reversed"
    SCALE = "scale"
    OFFSET = "offset"
    MISSED_STEPS = "missed steps"
    DRIFT = "drift"
    CLOCK = "clock"
    LOSS = "loss"
    NEW_HOME = "new home"
    FOLLOWED = "followed"


@dataclass(frozen=True)
class Finding:
    """A cause, the arms that it concerns, its size and a sentence about it."""

    cause: Cause
    sentence: str
    arms: tuple[str, ...] = ()
    value: float = math.nan
    """deg of BEGAN_APART and OFFSET, full steps of MISSED_STEPS, hardware / simulation - 1 of SCALE, s per s of DRIFT,
    s of CLOCK, share of LOSS, number of motions of NOT_ASKED"""
    t: float = math.nan
    """time since the begin of the comparison (s), if the cause has one"""


def listed(names: tuple[str, ...]) -> str:
    """Join names: 'short, middle and long'."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def count(number: int, what: str) -> str:
    """Return a number with its noun."""
    return f"{number} {what}" + "s" * (number != 1)
