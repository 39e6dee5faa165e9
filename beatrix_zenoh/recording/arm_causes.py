"""Findings, and why an arm differs: explanations fitted to the same differences, and compared by what they leave of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, NamedTuple

import numpy as np

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.motion_shifts import CLEARLY
from beatrix_zenoh.recording.series import Flags, Floats, runs


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
    CREEP = "creep"
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
    """deg of BEGAN_APART, OFFSET and CREEP, full steps of MISSED_STEPS at the end, hardware / simulation - 1 of SCALE,
    share of LOSS, number of motions of NOT_ASKED"""
    t: float = math.nan
    """time since the begin of the comparison (s), if the cause has one"""


def listed(names: tuple[str, ...]) -> str:
    """Join names: 'short, middle and long'."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def count(number: int, what: str) -> str:
    """Return a number with its noun."""
    return f"{number} {what}" + "s" * (number != 1)


FULL_STEP_DEG: Final = 360 / ROBOT.drive.full_steps * ROBOT.drive.gear_pinion / ROBOT.drive.gear_ring
APART_DEG: Final = 0.25
"""A smaller difference of an arm has no cause that is worth a sentence: noise, and motors that behave like springs."""
WHOLE_DEG: Final = 0.08
"""A whole number of full steps is at most this far from a change that they explain."""
CLEAR_DEG: Final = 3.0
"""An arm is judged if it turns by more than this."""
STILL_DEG: Final = 1.0
"""An arm that turns by less than this stands still."""
SCALE: Final = 0.01
"""Smallest error of scale that is reported."""
SCALES: Final = -0.6, 1.5
"""Errors of scale that are reported: beyond them the robots make different movements."""
STEPS: Final = 4
"""Largest number of losses of steps that are searched."""
BIN_S: Final = 0.1
"""Differences are averaged over this time (s), so that noise is small beside what an explanation leaves."""
FLOOR_DEG: Final = 0.1
"""Explanations that leave less than this are equally good."""
REST_S: Final = 0.2
"""Rests that are shorter than this (s) are not looked at."""


class ComparedSamples(NamedTuple):
    """Samples of both robots at times that can be compared: n rows, arms in deg."""

    t: Floats
    first: Floats
    second: Floats
    rest: Flags

    def where(self, kept: Flags) -> ComparedSamples:
        """Return only some of the samples."""
        return ComparedSamples(self.t[kept], self.first[kept], self.second[kept], self.rest[kept])


class Explanation(NamedTuple):
    """A number of effects that explain the differences of an arm."""

    effects: int
    left: float
    """sum of the squares that it leaves (deg2)"""
    findings: list[Finding]
    """empty: the effects are too small for a sentence, or have no known cause"""
    offset: float
    """difference (deg) without the effects"""


class Binned(NamedTuple):
    """Averages over BIN_S of one arm: n rows, angles in deg."""

    t: Floats
    mine: Floats
    apart: Floats
    rest: Flags


def rests(seen: ComparedSamples) -> list[tuple[int, int]]:
    """Return begin and end (exclusive) of each rest of both robots, without short ones."""
    return [(a, b) for a, b in runs(seen.rest) if seen.t[b - 1] - seen.t[a] > REST_S]


def causes_of(seen: ComparedSamples, arm: int) -> list[Finding]:
    """Return why one arm differs; empty: unknown.

    An explanation is used if it leaves clearly less than all others with as many effects or fewer.
    """
    name = ARMS[arm]
    mine, other = seen.first[:, arm], seen.second[:, arm]
    if np.ptp(mine) > CLEAR_DEG and np.ptp(other) < STILL_DEG:
        sentence = f"{name.capitalize()} stood still on the hardware: check its motor."
        return [Finding(Cause.STOOD_STILL, sentence, (name,))]
    binned = averaged(seen, arm)
    trials = [constant(binned), scaled(binned, name), crept(binned, name), *stepped(binned, name)]
    floor = len(binned.t) * FLOOR_DEG**2
    best = trials[0]
    for each in trials[1:]:
        simpler = [other.left for other in trials if other.effects <= each.effects and other is not each]
        if each.left + floor < CLEARLY * (min(simpler) + floor):
            best = each
    if not best.findings:
        best = trials[0]
    if abs(best.offset) < APART_DEG or len(rests(seen)) < 2:
        return best.findings
    changes = any(finding.cause is not Cause.SCALE for finding in best.findings)
    when = " at first" if changes else ", always"
    sentence = f"{name.capitalize()} is {best.offset:+.2f}° off at rest{when}: calibrate both robots at home."
    return [Finding(Cause.OFFSET, sentence, (name,), best.offset), *best.findings]


def averaged(seen: ComparedSamples, arm: int) -> Binned:
    """Return the averages of an arm; a bin is at rest if all of its samples are."""
    _, begins = np.unique(np.floor(seen.t / BIN_S), return_index=True)
    sizes = np.diff([*begins, len(seen.t)])
    mine, apart, rest = (
        np.add.reduceat(each, begins) / sizes
        for each in (seen.first[:, arm], (seen.second - seen.first)[:, arm], seen.rest * 1.0)
    )
    return Binned(seen.t[begins], mine, apart, rest == 1.0)


def constant(binned: Binned) -> Explanation:
    """Explain by an offset alone; it is 0 if the differences vary from rest to rest."""
    left = float(np.sum((binned.apart - binned.apart.mean()) ** 2))
    levels = [float(np.median(binned.apart[a:b])) for a, b in runs(binned.rest) if b - a > 1]
    offset = float(np.median(levels)) if levels else 0.0
    return Explanation(0, left, [], offset if np.ptp(levels or [0.0]) < abs(offset) / 2 else 0.0)


def scaled(binned: Binned, name: str) -> Explanation:
    """Explain by an arm that moves too far, or not far enough."""
    (slope, offset), left = line(binned.mine, binned.apart)
    way = float(np.ptp(binned.mine))
    named = abs(slope) > SCALE and SCALES[0] <= slope <= SCALES[1] and abs(slope) * way > 2 * APART_DEG
    return Explanation(1, left, [scale((name,), slope)] if named else [], offset)


def crept(binned: Binned, name: str) -> Explanation:
    """Explain by an arm that moves away steadily."""
    since = binned.t - binned.t[0]
    (slope, offset), left = line(since, binned.apart)
    value = slope * float(since[-1])
    sentence = (
        f"{name.capitalize()} moves away steadily, by {value:+.2f}° in {since[-1]:.1f} s: no single loss of steps explains it. "
        "Move both home and calibrate."
    )
    named = abs(value) > 2 * APART_DEG
    return Explanation(1, left, [Finding(Cause.CREEP, sentence, (name,), value)] if named else [], offset)


def line(x: Floats, y: Floats) -> tuple[tuple[float, float], float]:
    """Return slope and value at 0 of the line through points, and the sum of the squares that it leaves."""
    around = x - x.mean()
    slope = float(around @ y) / max(float(around @ around), 1e-9)
    offset = float(y.mean() - slope * x.mean())
    return (slope, offset), float(np.sum((y - offset - slope * x) ** 2))


def stepped(binned: Binned, name: str) -> Iterator[Explanation]:
    """Explain by 1 to STEPS sudden changes; each next one is where it explains most of what those before have left."""
    edges = [0, len(binned.t)]
    for effects in range(1, STEPS + 1):
        splits = [split(binned.apart[a:b], a) for a, b in itertools.pairwise(edges) if b - a > 1]
        if not splits:
            return
        edges = sorted([*edges, max(splits)[1]])
        parts = [slice(a, b) for a, b in itertools.pairwise(edges)]
        left = sum(float(np.sum((binned.apart[part] - binned.apart[part].mean()) ** 2)) for part in parts)
        at_rest = [binned.rest[part] for part in parts]
        if any(np.count_nonzero(rest) * BIN_S < REST_S for rest in at_rest):
            yield Explanation(effects, left, [], 0.0)
            continue
        levels = np.array(
            [np.median(binned.apart[part][rest]) for part, rest in zip(parts, at_rest, strict=True)]
        )
        times = [float(binned.t[edge]) for edge in edges[1:-1]]
        yield Explanation(effects, left, missed_steps(name, times, levels), float(levels[0]))


def split(apart: Floats, begin: int) -> tuple[float, int]:
    """Return the sum of squares that two levels explain in the place of one, and the index of the change plus `begin`."""
    n, sums = len(apart), np.cumsum(apart - apart.mean())
    before = np.arange(1, n)
    explained = sums[:-1] ** 2 * (1 / before + 1 / (n - before))
    best = int(np.argmax(explained))
    return float(explained[best]), begin + best + 1


def missed_steps(name: str, times: list[float], levels: Floats) -> list[Finding]:
    """Return the finding that an arm lost whole steps at some times (s); empty: a change is no whole number of them.

    Args:
        name: the arm.
        times: the k times of changes (s).
        levels: k + 1 differences at rest (deg) before, between and after the changes.
    """
    changes = np.diff(levels)
    steps = np.round(changes / FULL_STEP_DEG)
    if not steps.all() or np.any(np.abs(changes - steps * FULL_STEP_DEG) > WHOLE_DEG):
        return []
    total = int(steps.sum())
    off = " and ".join(
        f"{level:+.2f}° off from {t:.1f} s on" for level, t in zip(levels[1:], times, strict=True)
    )
    all_of_them = " in all" * (len(times) > 1)
    sentence = (
        f"{name.capitalize()} is {off}, {count(abs(total), 'full step')}{all_of_them}: the simulation's arm missed steps, or the "
        "hardware's count of steps changed (it notices no missed step). Move both home and calibrate."
    )
    return [Finding(Cause.MISSED_STEPS, sentence, (name,), float(total), times[0])]


def scale(arms: tuple[str, ...], value: float) -> Finding:
    """Return the finding that arms move too far, or not far enough."""
    more = "more" if value > 0 else "less"
    verb = "moves" if len(arms) == 1 else "move"
    name = "All arms" if len(arms) == len(ARMS) else listed(arms).capitalize()
    return Finding(
        Cause.SCALE,
        f"{name} {verb} {abs(value):.1%} {more} on the hardware: check gears, microsteps and the robot file.",
        arms,
        value,
    )
