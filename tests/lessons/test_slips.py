"""Slips: solutions whose functions return radians or the other sign, and motions of which a part is missing."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import cast

import numpy as np
import numpy.typing as npt
import pytest
from robots import until

from beatrix_zenoh.contract._generated.messages import (
    Event,
    EventKind,
    MotionQuery,
    Phase,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.lesson_files import find
from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt, Seen, Unmet
from beatrix_zenoh.lessons.checking import Verdict, check_of, verdict
from beatrix_zenoh.lessons.guarded import Run
from beatrix_zenoh.lessons.program import Program
from beatrix_zenoh.lessons.sandbox import Sandbox
from beatrix_zenoh.lessons.stage import SEAT

Change = Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]]


class Called:
    """An attempt that calls the functions of a solution, the one of a name with changed results, in this process."""

    require, used_s = staticmethod(Attempt.require), 0.0

    def __init__(self, lesson: int, function: str, change: Change) -> None:
        self._module: dict[str, object] = {"__name__": "solution"}
        path = find(lesson).folder / "solution.py"
        exec(compile(path.read_text(encoding="utf-8"), path, "exec"), self._module)
        right = cast("Callable[..., object]", self._module[function])

        def changed(*arguments: object) -> object:
            value = right(*arguments)
            return None if value is None else change(np.array(value, dtype=float)).tolist()

        self._module[function] = changed

    def value(self, function: str, *arguments: object) -> object:
        return cast("Callable[..., object]", self._module[function])(*arguments)

    call = value

    def call_array(
        self, function: str, *arguments: object, shape: tuple[int, ...]
    ) -> npt.NDArray[np.float64]:
        return np.array(self.value(function, *arguments), dtype=float).reshape(shape)


def said(number: int, function: str, change: Change) -> Verdict:
    lesson = find(number)
    with pytest.raises(Unmet) as unmet:
        check_of(lesson)(cast("Attempt", Called(number, function, change)))
    return verdict(lesson, unmet.value)


def figure_of(call: Callable[[], None], lesson: int = 1) -> str:
    """Return the figure that ends a call, whose texts must be complete; empty: none."""
    try:
        call()
    except Unmet as unmet:
        return "".join({verdict(find(lesson, language), unmet).figure for language in ("en", "de")})
    return ""


ANGLES = [
    (2, "degrees_per_step"),
    (2, "degrees_for"),
    (3, "rule"),
    (3, "arms_for_nod"),
    (4, "bearing"),
    (5, "inverse"),
    (5, "forward"),
    (7, "angle"),
    (9, "bearing"),
    (10, "direction"),
]


def tangent(angles: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.tan(np.radians(angles))


@pytest.mark.parametrize(
    ("lesson", "function", "change"), [*((*one, np.radians) for one in ANGLES), (9, "bearing", tangent)]
)
def test_radians_are_recognised_in_every_lesson(lesson: int, function: str, change: Change) -> None:
    found = said(lesson, function, change)
    assert (found.figure, "math.degrees" in found.means) == ("radians", True)
    assert function in found.found


@pytest.mark.parametrize(("lesson", "function"), [*ANGLES, (5, "closures"), (6, "speed_ratio"), (11, "rate")])
def test_the_other_sign_is_recognised_in_every_lesson(lesson: int, function: str) -> None:
    found = said(lesson, function, lambda v: -v)
    assert found.figure == "sign"
    assert "size" in found.means


@pytest.mark.parametrize(
    ("found", "true", "figure"),
    [
        ([0.1, 0.35, -0.7], [5.7, 20, -40], "radians"),
        ([0.0, 0.7, 0.7, 0.7, 30], [0, 40, 40, 40, 40], "radians"),  # one has a second fault
        ([-20, 40, 0.0], [20, -40, 0], "sign"),
        ([0, 0, 0], [20, -40, 30], ""),  # as with a loud fan
        ([19, 0.7, -0.7], [20, 40, -40], ""),  # one is right
        ([0.0], [0.0], ""),
        ([math.nan, math.nan], [20, 40], ""),
    ],
)
def test_a_slip_is_what_most_numbers_show(found: list[float], true: list[float], figure: str) -> None:
    assert figure_of(lambda: slips.numbers("f", found, true, 2.0)) == figure


def motion(*degrees: float, reason: Reason = Reason.OK, arms: bool = False, seat: str = "pupil") -> Event:
    """Return the event of a motion that a program has asked for."""
    angles = [math.radians(angle) for angle in degrees]
    return Event(
        seq=1,
        t_mono_ns=0,
        t_wall_ns=0,
        kind=EventKind.MOTION,
        seat=seat,
        reason=reason,
        phase=Phase.ACCEPTED,
        motion_query=MotionQuery(position=Vector3(*angles)) if arms else None,
        pose_query=None if arms else PoseQuery(yaw=angles[0], pitch=angles[1], roll=angles[2]),
    )


@pytest.mark.parametrize(
    ("events", "figure"),
    [
        ([], "nothing"),
        ([motion(15, 0, 0, seat=SEAT)], "nothing"),
        ([motion(0, 80, 0, reason=Reason.OUT_OF_REACH)] * 2, "all_refused"),
        ([motion(0, math.radians(15), 0), motion(0, 0, 0)], "tiny"),
        ([motion(0, math.radians(15), 0, arms=True)], "tiny"),
        ([motion(0, 80, 0, reason=Reason.OUT_OF_REACH), motion(0, 15, 0)], ""),
        ([motion(0, 0, 0)], ""),  # home
    ],
)
def test_a_program_that_moved_nothing_is_told_why(events: list[Event], figure: str) -> None:
    none = np.zeros((2, 3))
    seen = Seen(np.arange(2.0), none, none, none, none, events, np.zeros(len(events)))
    assert figure_of(lambda: slips.motions([seen])) == figure


@pytest.mark.parametrize("name", ["start.py", "start.ipynb"])
def test_a_program_finds_its_files_as_by_hand(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "lessons" / "12-character"
    folder.mkdir(parents=True)
    text = "open('scene.csv').close()"
    (folder / "start.py").write_text(text)
    (tmp_path / "scene.csv" if name == "start.py" else folder / "scene.csv").write_text("")
    monkeypatch.chdir(tmp_path)
    made = Program(folder / name, text)
    with contextlib.closing(Run(Sandbox(made, tmp_path), {})) as run:
        until(lambda: not run.running, "the program has ended")
        run.check()
