"""Check of lesson 12."""

from __future__ import annotations

import ast
import re

import numpy as np

from beatrix_zenoh.lessons.attempt import Attempt, Seen, Unmet
from beatrix_zenoh.lessons.measures import Curve

FASTEST = 40.0
"""Largest speed of an arm (deg/s), the limit of a turn on the robot.

Measured in steps of 0.1 s, in which an arm takes whole microsteps: 5 % more are not counted.
"""
PAUSE_S = 0.4
"""Half a second, less what the arms need to come to rest."""
STILL = 1.5
"""An arm that turns more slowly (deg/s) rests."""
ALIKE = 5.0
"""Figures whose angles differ by less (deg) are the same."""
WRONG_LINE = re.compile(r"Wrong\w+: .*?line (?P<line>\d+): (?P<error>.*?\.)( docs/|$)")
"""The error of a scene with a line that cannot be used."""
AXES = ("yaw", "pitch", "roll")


def check(attempt: Attempt) -> None:
    """Require a scene of 10 to 30 s with three figures, all axes, no hurry, and home at its end."""
    try:
        seen = attempt.observe()
    except Unmet as unmet:
        wrong = WRONG_LINE.match(str(unmet.values.get("error", "")))
        place = (
            attempt.program.place(first_line(attempt.program.text) + int(wrong["line"]) - 1) if wrong else ""
        )
        attempt.require("scene", not wrong, place=place, error=wrong and wrong["error"])
        raise
    parts = figures(seen)
    attempt.require("moves", bool(parts))
    length = float(seen.t[parts[-1].stop - 1] - seen.t[parts[0].start])
    attempt.require("length", 10 <= length <= 30, length=length)
    fastest = float(np.abs(np.diff(seen.commanded[::5], axis=0) / np.diff(seen.t[::5])[:, None]).max())
    attempt.require("speed", fastest <= 1.05 * FASTEST, fastest=fastest)
    different = distinct(seen, parts)
    attempt.require("figures", different >= 3, parts=len(parts), different=different)
    ranges = [float(np.ptp(seen.head[:, i])) for i in range(3)]
    least = int(np.argmin(ranges))
    attempt.require("axes", ranges[least] >= 10, axis=AXES[least], found=ranges[least])
    left = float(np.abs(seen.head[-1]).max())
    attempt.require("home", left <= 0.5, left=left)
    lost = float(np.abs(seen.arms - seen.commanded)[-1].max())
    attempt.require("steps", lost <= 0.3, lost=lost)


def first_line(text: str) -> int:
    """Return the line of the program in which the text of the scene begins."""
    strings = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)]
    return next((node.lineno for node in strings if "t_s" in str(node.value)), 1)


def figures(seen: Seen) -> list[slice]:
    """Return the stretches between pauses in which the head moves by 5 deg or more."""
    resting = np.abs(seen.speed).max(axis=1) < STILL
    begin, found, since = None, [], seen.t[0]
    for i, (t, rests) in enumerate(zip(seen.t, resting, strict=True)):
        if not rests:
            begin, since = i if begin is None else begin, t
        elif begin is not None and t - since >= PAUSE_S:
            found.append(slice(begin, i))
            begin = None
    if begin is not None:
        found.append(slice(begin, len(seen.t)))
    return [part for part in found if np.ptp(seen.head[part], axis=0).max() >= 5]


def distinct(seen: Seen, parts: list[slice]) -> int:
    """Return the number of stretches that differ from one another in the angles that they reach."""
    kinds: list[Curve] = []
    for part in parts:
        kind = np.concatenate((seen.head[part].min(axis=0), seen.head[part].max(axis=0)))
        if all(np.abs(kind - other).max() >= ALIKE for other in kinds):
            kinds.append(kind)
    return len(kinds)
