"""A motion under way."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.node.answers import Asker
from beatrix_zenoh.node.course import Goal

NUMBERS = 65535
"""The highest a motion can have."""


@dataclass(frozen=True)
class Running:
    """The motion the firmware carries out, and what to do when it has ended."""

    number: int
    asker: Asker
    goal: Goal
    boot: int
    until_s: float
    """When it should have ended, and some more (monotonic)."""
    end: Callable[[Reason, str], None]

    def overdue(self) -> bool:
        """It should have ended long ago."""
        return time.monotonic() > self.until_s


def next_number(last: int, boards: int) -> int:
    """Number of a motion: neither the last one nor the board's, which may be of a node before this one."""
    number = last % NUMBERS + 1
    return number % NUMBERS + 1 if number == boards else number
