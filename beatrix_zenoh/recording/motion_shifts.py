"""The shift in time of each motion of two robots, and its lag: what remains of the shift without the lead. Times are in s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from beatrix_zenoh.client.degrees import REST_DEG
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.series import GRID_S, Floats, Recording, common_grid, resample, sampled

NEAR_S = 0.5
"""Largest lag of the first search (s)."""
FAR_S = 5.0
"""Largest lag of the second search (s), made if no lag of the first search explains the second recording."""
EXPLAINED = 0.1
"""A lag explains the second recording if it leaves less than this share of the variance; no other lag is reported."""
GAINS = 0.4, 2.5
"""An arm of the second recording may turn less or more than that of the first by a factor between these: a wrong scale
hides no lag."""
STEP_FINE_S = 0.001
RATIOS = 1.0, 1.4, 2.0, 0.7
"""The search of a stretch begins at each of these."""
STRETCHED = 3.0
"""Largest stretch, and with its inverse the smallest, that is searched."""
ROUNDS = 6
"""Number of steps of Newton's method (Gauss-Newton) that find a stretch."""
TINY = 1e-9
"""Avoids a division by 0."""
MOST = 20_000
"""The largest number of samples that are compared; of longer recordings every n-th sample is used."""


class Shift(NamedTuple):
    """A shift of the second recording (s) and the share of the variance that it leaves unexplained."""

    s: float
    """NaN: the first rests, or the best shift is the longest or shortest of the search, so that it may be another"""
    left: float
    """inf: the first rests, or the second was not recorded"""

    @property
    def explains(self) -> bool:
        """Whether the shift is known and explains the second recording."""
        return self.left < EXPLAINED and not math.isnan(self.s)


class Stretch(NamedTuple):
    """A shift (s) of the begin of a movement, how many times as long it lasts, and the share of the variance left."""

    s: float
    ratio: float
    left: float


NO_SHIFT = Shift(math.nan, math.inf)


def lag(first: Recording, second: Recording, columns: Sequence[int] = tuple(range(len(ARMS)))) -> float:
    """Return the lag (s) of the second behind the first; NaN if nothing moved, or no lag up to 5 s explains the second.

    The lag is the shift with the least sum of squared differences in `columns`. The search has steps of the grid, then
    of 1 ms, and ends at the vertex of the parabola through the best value and both neighbours. Constant differences do
    not count. At least half of the shared time is compared, so the longest lag found is a quarter of that time.
    """
    t = common_grid(first, second)
    one, other = chosen(first, columns), chosen(second, columns)
    found = NO_SHIFT
    for limit_s in (NEAR_S, FAR_S):
        limit_s = min(limit_s, (t[-1] - t[0]) / 4)  # noqa: PLW2901
        inner = t[(t >= t[0] + limit_s) & (t <= t[-1] - limit_s)]
        found = min(found, best_shift(one, other, inner, 0.0, limit_s), key=lambda shift: shift.left)
        if found.left < EXPLAINED:
            break
    return found.s if found.explains else math.nan


def chosen(recorded: Recording, columns: Sequence[int]) -> Recording:
    """Return the recording with only these axes, without set points."""
    return replace(recorded, angles=recorded.angles[:, list(columns)], commanded=None)


def best_shift(first: Recording, second: Recording, t: Floats, around_s: float, limit_s: float) -> Shift:
    """Return the best shift of the second at times t (s), within `limit_s` of `around_s`, where it was recorded.

    Each axis of the second may turn further, or less far, than that of the first, within GAINS.
    """
    t = t[:: 1 + len(t) // MOST]
    if len(t) < 2:
        return NO_SHIFT
    still = resample(first, t)
    if np.max(np.ptp(still, axis=0)) < REST_DEG:
        return NO_SHIFT
    still -= still.mean(axis=0)
    power = np.sum(still**2, axis=0)
    lowest = max(around_s - limit_s, float(second.t[0] - t[0]))
    highest = min(around_s + limit_s, float(second.t[-1] - t[-1]))
    if highest - lowest < 2 * GRID_S:
        return NO_SHIFT

    def apart(shift_s: float) -> float:
        moved = resample(second, t + shift_s)
        moved -= moved.mean(axis=0)
        moved /= np.clip(np.sum(moved * still, axis=0) / np.maximum(power, TINY), *GAINS)
        return float(np.sum((moved - still) ** 2))

    shifts = np.arange(lowest, highest, GRID_S)
    coarse = int(np.argmin([apart(shift_s) for shift_s in shifts]))
    fine = shifts[coarse] + STEP_FINE_S * np.arange(-11, 12)
    costs = [apart(shift_s) for shift_s in fine]
    best = int(np.argmin(costs))
    left = costs[best] / float(np.sum(power))
    if best in (0, len(costs) - 1) or coarse in (0, len(shifts) - 1):
        return Shift(math.nan, left)
    before, at, after = costs[best - 1 : best + 2]
    curvature = before - 2 * at + after
    vertex = (before - after) / (2 * curvature) if curvature > 0 else 0.0
    return Shift(float(fine[best]) + STEP_FINE_S * min(0.5, max(-0.5, vertex)), left)


def best_stretch(first: Recording, second: Recording, t: Floats, begin_s: float, around_s: float) -> Stretch:
    """Return the shift near `around_s` (s) and the stretch with which a movement at times t (s) explains that of the second.

    The second makes at `begin_s + shift + ratio * (t - begin_s)` (s) what the first makes at t.
    """
    t = t[:: 1 + len(t) // MOST]
    best = Stretch(math.nan, 1.0, math.inf)
    if len(t) < 2:
        return best
    still = resample(first, t)
    still -= still.mean(axis=0)
    power = max(float(np.sum(still**2)), TINY)
    for start in RATIOS:
        found = np.array([around_s, start])
        for _ in range(ROUNDS):
            seconds = begin_s + found[0] + found[1] * (t - begin_s)
            moved = resample(second, seconds)
            slope = (resample(second, seconds + GRID_S) - resample(second, seconds - GRID_S)) / (2 * GRID_S)
            moved -= moved.mean(axis=0)
            left = float(np.sum((moved - still) ** 2)) / power
            best = min(best, Stretch(float(found[0]), float(found[1]), left), key=lambda each: each.left)
            columns = np.stack([slope, slope * (t - begin_s)[:, None]])
            columns -= columns.mean(axis=1, keepdims=True)
            step, *_ = np.linalg.lstsq(columns.reshape(2, -1).T, (still - moved).ravel(), rcond=None)
            found = np.clip(found + step, (around_s - NEAR_S, 1 / STRETCHED), (around_s + NEAR_S, STRETCHED))
    return best


LOCAL_S = 0.15
"""Largest difference of the first search between the shift of a motion and that of its requests."""
AROUND_S = 0.1
"""A motion is compared with this much rest before and after it."""
AGREE_S, AGREE_DEG = 0.03, 0.3
"""Shifts of two arms in one motion agree if they differ by less than this (s), or if that is less than this angle (deg) in
the slowest arm. A stretch must change an arm by more than this angle, too."""
CLEAR_DEG, CLEAR = 3.0, 0.1
"""The shift of an arm is judged if it turns by more than this, and by more than this share of the arm that turns most."""
SOONER_S = 0.5
"""A hardware that begins this much before the end of the lead was sent the motion by a click."""
WIDE_S = 1.0
"""Largest difference between the shift of a motion and that of its requests; a clock that jumps further leaves a hole."""
EDGE_S = 0.05
"""Samples further apart than this (s) than the shift of a motion was measured from are in a gap."""
STRETCH = 0.05
"""Smallest difference between the durations of a movement that is reported, as a share."""
CLEARLY = 0.4
"""One explanation is clearly better than another if it leaves less than this share of what the other leaves."""
ALIKE = 0.8
"""Two explanations are alike if one leaves more than this share of what the other leaves."""
FEWEST = 5
"""Number of motions from which lags that differ can be told from chance."""
DIFFER_S = 0.15
"""If the lags of the middle three of five motions differ by more than this (s), no lag is that of all motions."""


@dataclass(frozen=True)
class MovedPart:
    """A motion of both robots: times by the clock of the first."""

    begin_s: float
    end_s: float
    lead_s: float | None
    """the lead that was requested; None: no lead was requested, or the requests were not recorded"""
    shift_s: float
    """start of the second minus start of the first; if `lag_s` is NaN, the best estimate"""
    lag_s: float
    """what remains of `shift_s` without the lead; NaN: unknown"""
    why: str = ""
    """why the lag is unknown"""
    measured: bool = True
    """whether `shift_s` was measured"""


@dataclass(frozen=True)
class Expected:
    """A motion of the first robot, and what is known about its shift before it is measured."""

    begin_s: float
    end_s: float
    shift_s: float
    lead_s: float | None = None
    unknown: str = ""
    """why the lag is unknown, whatever is measured"""
    limits_s: tuple[float, ...] = (LOCAL_S, NEAR_S, WIDE_S)
    single: bool = True
    """whether one request, or an unknown number of requests, caused it"""
    requested: bool = True
    """whether it was recorded which request caused it"""


def window(
    first: Recording, second: Recording, motion: Expected | MovedPart, limit_s: float = LOCAL_S
) -> Floats:
    """Return the times of the first at which a motion is compared with the second, for shifts up to `limit_s` (s).

    Times in a gap of a recording are left out; there are none if less than a quarter of the motion remains.

    At the ends of the recordings up to half of the motion is left out, so that the second was recorded at each shift.
    """
    begin_s = max(motion.begin_s - AROUND_S, float(first.t[0]))
    t = np.arange(begin_s, min(motion.end_s + AROUND_S, float(first.t[-1])), GRID_S)
    seconds = t + motion.shift_s
    inner = t[(seconds - limit_s >= second.t[0]) & (seconds + limit_s <= second.t[-1])]
    kept = inner if 2 * len(inner) >= len(t) else t
    seconds = kept + motion.shift_s
    seen = kept[sampled(first, kept) & sampled(second, seconds, EDGE_S)]
    return seen if 4 * len(seen) >= len(kept) else seen[:0]


def measured(first: Recording, second: Recording, motion: Expected) -> MovedPart:
    """Measure the shift of a motion; it stays unknown if no shift explains the movement of each arm."""
    one, other = chosen(first, range(len(ARMS))), chosen(second, range(len(ARMS)))
    found, t = Shift(math.nan, math.inf), first.t
    for limit_s in motion.limits_s:
        t = window(first, second, motion, limit_s)
        found = best_shift(one, other, t, motion.shift_s, limit_s)
        if found.explains:
            break
    lead_s = motion.lead_s or 0.0
    if not len(t):
        shift_s, why = math.nan, "most of it lies in gaps of the recordings"
    else:
        shift_s, why = slower(one, other, motion, found.left) if motion.single else (math.nan, "")
        if not why:
            shift_s, why = by_arm(one, other, t, found, found.s if found.explains else motion.shift_s)
        if not why:
            shift_s, why = found.s if found.explains else math.nan, unknown(found, motion.limits_s[-1])
    if lead_s and shift_s < lead_s - SOONER_S:
        why = why or f"the hardware began {lead_s - shift_s:.1f} s before the lead of {lead_s:g} s had ended"
    why = motion.unknown or why
    known = not math.isnan(shift_s)
    if not known:
        shift_s = motion.shift_s if motion.requested else nearer(one, other, motion, 0.0)
    return MovedPart(
        motion.begin_s,
        motion.end_s,
        motion.lead_s,
        shift_s,
        math.nan if why else shift_s - lead_s,
        why,
        known,
    )


def nearer(one: Recording, other: Recording, motion: Expected, shift_s: float) -> float:
    """Return the expected shift (s) of a motion, or another one if the robots are more alike with it."""
    t = np.arange(motion.begin_s, motion.end_s + GRID_S, GRID_S)
    still = resample(one, t)
    return min((motion.shift_s, shift_s), key=lambda each: np.sum((resample(other, t + each) - still) ** 2))


def unknown(found: Shift, limit_s: float) -> str:
    """Return why a shift is unknown; empty: it is known."""
    if found.left == math.inf:
        return "the recording ends before the hardware made it"
    if found.left >= EXPLAINED:
        return f"no shift of up to {limit_s:g} s explains more than {max(0.0, 1 - found.left):.0%} of the movement"
    return f"the shift is longer than the {limit_s:g} s that were searched" if math.isnan(found.s) else ""


def slower(first: Recording, second: Recording, motion: Expected, left: float) -> tuple[float, str]:
    """Return a shift (s), and a sentence, if the movement of the second lasts longer or not so long.

    It does if a stretch of time explains the movement clearly better than a shift, which leaves the share `left`, and than
    arms that turn further, or less far. If it is only a little better, the sentence has both explanations.
    """
    t = window(first, second, motion, 0.0)
    found = best_stretch(first, second, t, motion.begin_s, motion.shift_s)
    if not found.left < min(EXPLAINED, ALIKE * left):
        return math.nan, ""
    way = float(np.ptp(resample(first, t), axis=0).max())
    if abs(found.ratio - 1) < STRETCH or abs(found.ratio - 1) * way < AGREE_DEG:
        return math.nan, ""
    lasts = f"movement lasts {found.ratio:.2f} times as long as the simulation's"
    why = (
        f"the hardware's {lasts}" if found.left < CLEARLY * left else f"the hardware is late, or its {lasts}"
    )
    return nearer(first, second, motion, found.s), why


def by_arm(one: Recording, other: Recording, t: Floats, shift: Shift, around_s: float) -> tuple[float, str]:
    """Return the shift (s) of most arms, and a sentence, if arms that turn clearly have different shifts.

    The shift is NaN if it is not known which arms are late. The sentence is empty if the arms have the common shift, or
    do not explain why there is none.
    """
    ways = np.ptp(resample(one, t), axis=0)
    clear = [i for i in range(len(ARMS)) if ways[i] > max(CLEAR_DEG, CLEAR * ways.max())]
    own = {ARMS[i]: best_shift(chosen(one, [i]), chosen(other, [i]), t, around_s, NEAR_S) for i in clear}
    unlike = [arm for arm, each in own.items() if each.left >= 2 * EXPLAINED or math.isnan(each.s)]
    if unlike or len(own) < 2:
        only = shift.explains and unlike[:1]
        return math.nan, f"the {only[0]} arm does not move as the others do" if only else ""
    typical_s = float(np.median([each.s for each in own.values()]))
    *others, arm = sorted(own, key=lambda each: (abs(own[each].s - typical_s), own[each].s))
    late_s = own[arm].s - own[others[0]].s
    slowest = min(ways[ARMS.index(each)] for each in own) / (len(t) * GRID_S)
    if abs(late_s) < max(AGREE_S, AGREE_DEG / slowest):
        return math.nan, ""
    moves = f"the {arm} arm moves about {round(abs(late_s), 2) * 1e3:.0f} ms {'later' if late_s > 0 else 'earlier'} than"
    if len(others) == 1:
        return math.nan, f"{moves} the {others[0]} arm"
    if abs(own[others[1]].s - own[others[0]].s) > AGREE_S:
        return math.nan, "each arm moves at another time"
    return own[others[0]].s, f"{moves} the others"


def differ(parts: Sequence[MovedPart]) -> bool:
    """Return whether the lags of the motions differ so much that their median is no lag of all motions."""
    known = [part.lag_s for part in parts if not math.isnan(part.lag_s)]
    return len(known) >= FEWEST and float(np.ptp(np.percentile(known, (20, 80)))) > DIFFER_S
