"""The shift of each motion of two robots, and its lag: what remains of the shift without the lead. Times are in s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.lag import (
    EXPLAINED,
    NEAR_S,
    Shift,
    best_shift,
    best_stretch,
    chosen,
    gains,
)
from beatrix_zenoh.recording.series import GRID_S, Floats, Recording, resample, sampled

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
"""Number of motions from which a change of the lag can be told from chance."""
EQUAL_S = 0.05
"""Lags that differ by less than this (s) are equal."""


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


def all_measured(first: Recording, second: Recording, expected: Sequence[Expected]) -> tuple[MovedPart, ...]:
    """Measure the shift of each motion; if none is found, with each arm of the second in the scale of the first."""
    parts = tuple(measured(first, second, motion) for motion in expected)
    if any(part.measured for part in parts):
        return parts
    windows = [window(first, second, part) for part in parts]
    t = np.concatenate([np.empty(0), *windows])
    if len(t) < 2:
        return parts
    one, other = (chosen(each, range(len(ARMS))) for each in (first, second))
    shifts = np.repeat([part.shift_s for part in parts], [len(each) for each in windows])
    factors = gains(one, other, t, t + shifts)
    rescaled = tuple(
        measured(first, replace(other, angles=other.angles / factors), motion) for motion in expected
    )
    return rescaled if any(not part.why for part in rescaled) else parts


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
    left = min(left, best_shift(first, second, t, motion.shift_s, NEAR_S, scaled=True).left)
    if not found.left < ALIKE * left:
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


def jump(parts: Sequence[MovedPart]) -> tuple[float, float] | None:
    """Return time (s) and size (s) of the change if the lag changes once, and is constant before and after; else None."""
    known = [part for part in parts if not math.isnan(part.lag_s)]
    if len(known) < FEWEST:
        return None
    lags = np.array([part.lag_s for part in known])
    at = int(np.argmax(np.abs(np.diff(lags)))) + 1
    size_s = float(np.median(lags[at:]) - np.median(lags[:at]))
    varies_s = max(np.ptp(lags[:at]), np.ptp(lags[at:]))
    if abs(size_s) < max(EQUAL_S, 4 * varies_s) or not 2 <= at <= len(known) - 2:
        return None
    return known[at].begin_s, size_s
