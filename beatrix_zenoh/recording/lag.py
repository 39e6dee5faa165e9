"""The lag of one recording behind another, as a whole and for each motion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from beatrix_zenoh.recording.series import (
    ARMS,
    GRID_S,
    REST_DEG,
    Flags,
    Floats,
    Recording,
    common_grid,
    resample,
    resting,
)

NEAR_S = 0.5
"""Largest lag of the first search (s)."""
FAR_S = 5.0
"""Largest lag of the second search (s), made if no lag of the first search explains the second recording."""
LOCAL_S = 0.15
"""The largest difference between the lag of one motion and the lag of the whole recording."""
EXPLAINED = 0.1
"""A lag explains the second recording if it leaves less than this share of the variance."""
UNEXPLAINED = 0.5
"""A lag is not reported if it leaves more than this share of the variance."""
STEP_FINE_S = 0.001
MOST = 20_000
"""The largest number of samples that are compared; of longer recordings every n-th sample is used."""


class Shift(NamedTuple):
    """A shift of the second recording (s) and the share of the variance that it leaves unexplained."""

    s: float
    left: float


class MovedPart(NamedTuple):
    """A motion of one robot or both, from rest to rest: times by the clock of the first, lag of the second (s)."""

    begin_s: float
    end_s: float
    lag_s: float


def lag(first: Recording, second: Recording, columns: Sequence[int] = tuple(range(len(ARMS)))) -> float:
    """Return the lag (s) of the second behind the first; NaN if nothing moved, or no lag up to 5 s explains the second.

    The lag is the shift with the least sum of squared differences in `columns`. The search has steps of the grid, then
    of 1 ms, and ends at the vertex of the parabola through the best value and both neighbours. Constant differences do
    not count. At least half of the shared time is compared, so the longest lag found is a quarter of that time.
    """
    t = common_grid(first, second)
    one, other = chosen(first, columns), chosen(second, columns)
    found = Shift(math.nan, math.inf)
    for limit_s in (NEAR_S, FAR_S):
        limit_s = min(limit_s, (t[-1] - t[0]) / 4)  # noqa: PLW2901
        inner = t[(t >= t[0] + limit_s) & (t <= t[-1] - limit_s)]
        found = min(found, best_shift(one, other, inner, 0.0, limit_s), key=lambda shift: shift.left)
        if found.left < EXPLAINED:
            break
    return found.s if found.left < UNEXPLAINED else math.nan


def chosen(recorded: Recording, columns: Sequence[int]) -> Recording:
    """Return the recording with only these axes."""
    return Recording(recorded.t, recorded.angles[:, list(columns)])


def best_shift(first: Recording, second: Recording, t: Floats, around_s: float, limit_s: float) -> Shift:
    """Return the best shift of the second at times t (s), within `limit_s` of `around_s`; NaN if the first rests."""
    t = t[:: 1 + len(t) // MOST]
    still = resample(first, t)
    if np.max(np.ptp(still, axis=0)) < REST_DEG:
        return Shift(math.nan, math.inf)
    still -= still.mean(axis=0)

    def apart(shift_s: float) -> float:
        moved = resample(second, t + shift_s)
        return float(np.sum((moved - moved.mean(axis=0) - still) ** 2))

    count = max(1, int(limit_s / GRID_S) - 1)
    coarse_s = min((around_s + i * GRID_S for i in range(-count, count + 1)), key=apart)
    shifts = [coarse_s + i * STEP_FINE_S for i in range(-11, 12)]
    costs = [apart(shift_s) for shift_s in shifts]
    best = min(range(1, len(shifts) - 1), key=lambda i: costs[i])
    before, at, after = costs[best - 1 : best + 2]
    curvature = before - 2 * at + after
    vertex_s = STEP_FINE_S * (before - after) / (2 * curvature) if curvature > 0 else 0.0
    return Shift(shifts[best] + vertex_s, at / float(np.sum(still**2)))


def moved_parts(first: Recording, second: Recording, lag_s: float) -> list[MovedPart]:
    """Return the motions of both, each with its own lag or, if that is unknown, `lag_s` (s), that of the recording.

    Lags differ because the request of each motion has its own delay.
    """
    shifted = Recording(second.t - lag_s, second.angles)
    t = common_grid(first, shifted)
    moving = ~(resting(resample(first, t)) & resting(resample(shifted, t)))
    one, other = chosen(first, range(len(ARMS))), chosen(second, range(len(ARMS)))
    parts = []
    for begin, end in runs(moving):
        begin_s, end_s = float(t[begin]), float(t[end - 1])
        within = second.t[0] + LOCAL_S < begin_s + lag_s and end_s + lag_s < second.t[-1] - LOCAL_S
        found = best_shift(one, other, t[begin:end], lag_s, LOCAL_S) if within else Shift(math.nan, math.inf)
        parts.append(MovedPart(begin_s, end_s, found.s if found.left < UNEXPLAINED else lag_s))
    return parts


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return begin and end (exclusive) of each run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]


def without_lag(second: Recording, t: Floats, lag_s: float, parts: Sequence[MovedPart]) -> Floats:
    """Return the angles of the second at times t (s) of the first, after removal of each motion's lag."""
    shifts = np.full(len(t), lag_s)
    if parts:
        # Both rest between two motions, so the lag may change anywhere there.
        ends = [(before.end_s + after.begin_s) / 2 for before, after in itertools.pairwise(parts)]
        shifts = np.array([part.lag_s for part in parts])[np.searchsorted(ends, t)]
    return resample(second, t + shifts)
