"""Checks of the programs of lessons, and their wrong programs: small differences to the solutions."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import msgspec
import pytest
from _pytest.mark import ParameterSet

from beatrix_zenoh.lesson_files import Lesson
from beatrix_zenoh.lessons import program
from beatrix_zenoh.lessons.checking import Result, Verdict, check
from beatrix_zenoh.lessons.phrases import Tell
from beatrix_zenoh.lessons.stage import Stage, open_stage
from beatrix_zenoh.lessons.watching import tidy
from sim_node.target import HOME

BUSY_TRIES = 2
ALWAYS = "02-"
"""The lesson that `make test` checks: it observes a robot and calls functions."""
MOVES = "02-steps/two_steps"
"""A wrong program of this lesson that moves its robot as long as the solution does."""
WRONG = Path(__file__).resolve().parents[1] / "lessons/wrong"


class Wrong(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A wrong program of a lesson, as its table in `tests/lessons/wrong`."""

    expects: str
    """the figure with which it fails"""
    changes: tuple[tuple[str, str], ...]
    """what it has instead of which part of the solution"""

    def program(self, solution: str) -> str:
        """Return the program; raises ValueError if a part is not, or more than once, in the solution."""
        for old, new in self.changes:
            if solution.count(old) != 1:
                raise ValueError(f"{old!r} is {solution.count(old)} times in the solution: change this row.")
            solution = solution.replace(old, new)
        return solution


def wrong_programs(lesson: str) -> dict[str, Wrong]:
    """Return the wrong programs of a lesson by name."""
    table = tomllib.loads((WRONG / f"{lesson}.toml").read_text(encoding="utf-8"))
    return msgspec.convert(table, dict[str, Wrong])


def of_lesson(value: object, lesson: str, name: str) -> ParameterSet:
    """Return a value of a parametrized test; only the lesson ALWAYS is checked in `make test`."""
    marks = (
        ()
        if lesson.startswith(ALWAYS) and name != MOVES
        else pytest.mark.long("programs move a robot in real time")
    )
    return pytest.param(value, marks=marks, id=name)


def tidied(stage: Stage) -> Stage:
    """Return a stage whose robot is at home again, and the person at their usual place."""
    assert tidy(stage, stage.names[0], HOME)
    return stage


def checked(lesson: Lesson, path: Path, stage: Stage) -> Verdict:
    """Check a program, on this stage where it fits, because the start of another one takes as long as most programs.

    If this computer is too busy, try again, and then skip the test: that is no verdict.
    """

    def shared(
        names: Sequence[str], path: str, robot_file: Path | None, tell: Tell
    ) -> AbstractContextManager[Stage]:
        if (tuple(names), path, robot_file) == (stage.names, "still", None):
            return nullcontext(tidied(stage))
        return open_stage(names, path, robot_file, tell)

    why = ""
    for _ in range(BUSY_TRIES):
        verdict = check(lesson, program.read(path), stages=shared)
        if verdict.result is not Result.NOT_MEASURABLE:
            return verdict
        why = verdict.means
    pytest.skip(why)
