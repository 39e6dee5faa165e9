"""The shift in time between two recordings of one movement."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from beatrix_zenoh.client.degrees import REST_DEG
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.series import GRID_S, Floats, Recording, common_grid, resample

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


def gains(first: Recording, second: Recording, t: Floats, seconds: Floats) -> Floats:
    """Return for each axis how much further the second turns at times `seconds` (s) than the first at times t, in GAINS."""
    one, other = resample(first, t), resample(second, seconds)
    one, other = one - one.mean(axis=0), other - other.mean(axis=0)
    return np.asarray(np.clip(np.sum(one * other, axis=0) / np.maximum(np.sum(one**2, axis=0), TINY), *GAINS))


def best_shift(
    first: Recording, second: Recording, t: Floats, around_s: float, limit_s: float, *, scaled: bool = False
) -> Shift:
    """Return the best shift of the second at times t (s), within `limit_s` of `around_s`, where it was recorded.

    With `scaled` each axis of the second may turn further, or less far, than that of the first, within GAINS.
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
        if scaled:
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
