"""The shift in time of each motion of two robots, and its lag: what remains of the shift without the lead. Times are in s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from beatrix_zenoh.client.degrees import REST_DEG
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.series import GRID_S, Floats, Recording, resample, sampled

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


NO_SHIFT = Shift(math.nan, math.inf)


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


LOCAL_S = 0.15
"""Largest difference of the first search between the shift of a motion and that of its requests."""
AROUND_S = 0.1
"""A motion is compared with this much rest before and after it."""
AGREE_S, AGREE_DEG = 0.045, 0.3
"""Shifts within one motion agree if they differ by less than this (s), or by less than the slowest arm needs for this angle
(deg)."""
NOISE_S = 0.6
"""Noise changes a shift by less than this (s) times its amplitude as a share of the movement."""
CLEAR_DEG, CLEAR = 3.0, 0.1
"""The shift of an arm is judged if it turns by more than this, and by more than this share of the arm that turns most."""
SOONER_S = 0.5
"""A hardware that begins this much before the end of the lead was sent the motion by a click."""
WIDE_S = 1.0
"""Largest difference between the shift of a motion and that of its requests; a clock that jumps further leaves a hole."""
EDGE_S = 0.05
"""Samples further apart than this (s) than the shift of a motion was measured from are in a gap."""
FEWEST = 5
"""Number of motions from which lags that differ can be told from chance."""
DIFFER_S = 0.15
"""If the lags of the middle three of five motions differ by more than this (s), no lag is that of all motions."""


@dataclass(frozen=True)
class MovedPart:
    """A motion of both robots: times by the clock of the first. Before it is measured, what the requests say of it."""

    begin_s: float
    end_s: float
    lead_s: float | None
    """the lead that was requested; None: no lead was requested, or the requests were not recorded"""
    shift_s: float
    """start of the second minus start of the first; if it was not measured, what the requests say"""
    lag_s: float = math.nan
    """what remains of `shift_s` without the lead; NaN: unknown"""
    why: str = ""
    """why the lag is unknown"""
    measured: bool = False
    """whether `shift_s` was measured"""
    single: bool = True
    """whether one request, or an unknown number of requests, caused it"""


def window(first: Recording, second: Recording, motion: MovedPart, limit_s: float = LOCAL_S) -> Floats:
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


def measured(first: Recording, second: Recording, motion: MovedPart) -> MovedPart:
    """Measure the shift of a motion; it stays unknown if no shift explains the movement of each arm."""
    one, other = chosen(first, range(len(ARMS))), chosen(second, range(len(ARMS)))
    found, t = Shift(math.nan, math.inf), first.t
    for limit_s in (LOCAL_S, NEAR_S, WIDE_S):
        t = window(first, second, motion, limit_s)
        found = best_shift(one, other, t, motion.shift_s, limit_s)
        if found.explains:
            break
    known = found.explains and even(one, other, t, motion, found.s)
    lead_s, shift_s = motion.lead_s or 0.0, found.s if known else motion.shift_s
    why = motion.why
    if not why and not known:
        why = unknown(found) if len(t) else "most of it lies in gaps of the recordings"
    elif not why and lead_s and shift_s < lead_s - SOONER_S:
        why = f"the hardware began {lead_s - shift_s:.1f} s before the lead of {lead_s:g} s had ended"
    lag_s = math.nan if why else shift_s - lead_s
    return replace(motion, shift_s=shift_s, lag_s=lag_s, why=why, measured=known)


def unknown(found: Shift) -> str:
    """Return why a shift is unknown."""
    if found.left == math.inf:
        return "the recording ends before the hardware made it"
    if found.left >= EXPLAINED:
        return f"no shift of up to {WIDE_S:g} s explains more than {max(0.0, 1 - found.left):.0%} of the movement"
    if math.isnan(found.s):
        return f"the shift is longer than the {WIDE_S:g} s that were searched"
    return "the arms, or begin and end of the movement, have different lags"


def even(one: Recording, other: Recording, t: Floats, motion: MovedPart, shift_s: float) -> bool:
    """Return whether a shift is that of the whole motion: of each arm that turns clearly, at its begin and at its end.

    The ends of a motion are compared if one request caused it: the hardware may be slower, or accelerate less.
    """
    ways = np.ptp(resample(one, t), axis=0)
    clear = [i for i in range(len(ARMS)) if ways[i] > max(CLEAR_DEG, CLEAR * ways.max())]
    if not clear:
        return True
    arms = [best_shift(chosen(one, [i]), chosen(other, [i]), t, shift_s, NEAR_S) for i in clear]
    ends = (
        [best_shift(one, other, half, shift_s, NEAR_S) for half in np.array_split(t, 2)]
        if motion.single
        else []
    )
    slowest = float(min(ways[clear])) / (len(t) * GRID_S)
    return agree(arms, max(AGREE_S, AGREE_DEG / slowest)) and agree(ends, AGREE_S)


def agree(shifts: Sequence[Shift], within_s: float) -> bool:
    """Return whether shifts are known and differ by less than a time (s), or than the noise of the angles explains."""
    if any(each.left >= 2 * EXPLAINED or math.isnan(each.s) for each in shifts):
        return False
    noise_s = NOISE_S * math.sqrt(max((each.left for each in shifts), default=0.0))
    return not shifts or float(np.ptp([each.s for each in shifts])) < max(within_s, noise_s)


def differ(parts: Sequence[MovedPart]) -> bool:
    """Return whether the lags of the motions differ so much that their median is no lag of all motions."""
    known = [part.lag_s for part in parts if not math.isnan(part.lag_s)]
    return len(known) >= FEWEST and float(np.ptp(np.percentile(known, (20, 80)))) > DIFFER_S
