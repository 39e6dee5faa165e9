"""A motion under way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.node.answers import Asker
from beatrix_zenoh.node.course import Goal


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
