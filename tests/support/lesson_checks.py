"""Checks of the programs of lessons."""

from __future__ import annotations

from pathlib import Path

import pytest
from _pytest.mark import ParameterSet

from beatrix_zenoh.lessons import program
from beatrix_zenoh.lessons.checking import Result, Verdict, check
from beatrix_zenoh.lessons.lesson import Lesson
from beatrix_zenoh.lessons.stage import Stage

BUSY_TRIES = 2
ALWAYS = "02-"
"""The lesson that `make test` checks: it observes a robot and calls functions."""


def of_lesson(value: object, lesson: str, name: str) -> ParameterSet:
    """Return a value of a parametrized test; only the lesson ALWAYS is checked in `make test`."""
    marks = () if lesson.startswith(ALWAYS) else pytest.mark.long("programs move a robot in real time")
    return pytest.param(value, marks=marks, id=name)


def checked(lesson: Lesson, path: Path, stage: Stage) -> Verdict:
    """Check a program; if this computer is too busy, try again, and then skip the test: that is no verdict."""
    why = ""
    for _ in range(BUSY_TRIES):
        verdict = check(lesson, program.read(path), stage=stage)
        if verdict.result is not Result.NOT_MEASURABLE:
            return verdict
        why = verdict.means
    pytest.skip(why)
