"""What the window knows about the lessons of its user at one moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import msgspec


class CheckReport(msgspec.Struct, frozen=True):
    """A line of `beatrix lesson watch --json`: a check that has begun or ended, or why there is none."""

    lesson: str = ""
    outcome: str = ""
    """`checks`, `passed`, `not_yet` or `not_measurable`; empty: `message` says why there was no check"""
    asked: str = ""
    found: str = ""
    message: str = ""
    picture: str = ""
    """file with what was asked and done (SVG); empty: none"""


@dataclass(frozen=True)
class LessonRun:
    """Lessons of the folder in which the window was started."""

    passed: frozenset[str] = frozenset()
    """names of the lessons whose programs have passed"""
    programs: Mapping[str, str] = field(default_factory=dict)
    """by lesson that was started: path of the program"""
    watched: int = 0
    """number of the lesson whose program is checked at each save; 0: none"""
    report: CheckReport = field(default_factory=CheckReport)
    """the newest"""
    hint: str = ""
    """the last hint; empty: none was asked for"""
    note: str = ""
    """why a start or a hint is refused; empty: it is not"""
