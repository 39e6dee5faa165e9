"""Compare two recordings of one movement: leads, lags and differences."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.alignment import LOCAL_S, Alignment, MovedPart, aligned, window
from beatrix_zenoh.recording.lag import EXPLAINED, best_shift, chosen
from beatrix_zenoh.recording.requests import Alone, Shared
from beatrix_zenoh.recording.series import (
    AXES,
    HEAD,
    Flags,
    Floats,
    Recording,
    Regularity,
    common_grid,
    heads_apart,
    new_homes,
    regularity,
    resample,
    resting,
    sampled,
    turned,
    unbroken,
)

HEADS = "head"
"""Name of the last row: the angle between both heads."""


@dataclass(frozen=True)
class AxisDifference:
    """Differences (deg) and lag (s) between two robots in one axis, or between their heads.

    NaN: at no time can both robots be compared.
    """

    axis: str
    lag_s: float
    """median lag of the second robot behind the first in the motions of the axis, without leads; NaN: unknown"""
    largest: float
    rms: float
    largest_after: float
    """largest difference after removal of each motion's lead and lag"""
    rms_after: float
    at_rest: float
    """largest difference while both rest, after that removal; NaN: they never rest at the same time"""
    offset: float
    """mean of second minus first while both rest, after that removal; NaN: they never rest at the same time"""


@dataclass(frozen=True)
class Comparison:
    """The comparison of a second recording with a first, on a common grid of times."""

    lag_s: float
    """median lag (s) of the set points of the second robot behind those of the first, or of its positions if its set
    points were not recorded, without the leads; NaN: unknown"""
    moved: tuple[MovedPart, ...]
    """the motions, each with the lead and the lag of its positions"""
    alone: tuple[Alone, ...]
    """the motions that only one robot made; they are no differences"""
    followed: tuple[Alone, ...]
    """the motions of the hardware that the simulation made, too, without being asked: it follows"""
    early: tuple[Shared, ...]
    """the motions that one robot carried out to the end, and the other did not; they are no differences"""
    t: Floats
    """times (s)"""
    first: Floats
    """angles (deg) of the first robot, one row per time: arms, then head"""
    second: Floats
    """angles of the second robot, as `first`"""
    second_after: Floats
    """angles of the second robot after removal of each motion's lead and lag, as `first`"""
    asked: tuple[bool, bool]
    """for each robot, whether it accepted a request, or its requests were not recorded"""
    compared: Flags
    """at which times the differences were taken: where both robots were recorded without a gap, and asked for the
    same movement"""
    rest: Flags
    """at which of these times both rest"""
    axes: tuple[AxisDifference, ...]
    """arms, head, and the angle between both heads"""
    off_set_points: tuple[float, float]
    """for each robot, the largest distance of an arm from its set point while both robots rest (deg); NaN: unknown. A
    lost full step is 0.69 deg."""
    regularity: tuple[Regularity, Regularity]
    homes: tuple[int, int]
    """for each robot, how often CALIBRATE gave it another home; the recordings are cut there"""

    @property
    def seconds(self) -> float:
        """Duration (s) of the compared part, the longest part without a hole in either recording."""
        return float(self.t[-1] - self.t[0])

    @property
    def arms_at_rest(self) -> float:
        """Largest difference of any arm while both rest (deg); NaN if they never rest at the same time."""
        return max(axis.at_rest for axis in self.axes[: len(ARMS)])

    @property
    def anything_moved(self) -> bool:
        """Whether an arm of either robot moved."""
        return not (resting(self.first).all() and resting(self.second).all())


def compare(first: Recording, second: Recording) -> Comparison:
    """Compare two recordings over the longest common part without a hole; both must have times of one clock.

    Raises:
        ValueError: that part is shorter than a second, or a recording has fewer than two positions.
    """
    whole = first, second
    first, second = unbroken(first, second)
    t = common_grid(first, second)
    found = aligned(first, second)
    seconds = found.second_s(t)
    a, b, c = resample(first, t), resample(second, t), resample(second, seconds)
    compared = found.comparable(t) & (seconds >= second.t[0]) & (seconds <= second.t[-1])
    compared &= sampled(first, t) & sampled(second, seconds)
    rest = resting(a) & resting(c) & compared
    before, after = differences(a, b), differences(a, c)
    return Comparison(
        lag_s=median_lag(first.arms, second.arms, found, tuple(range(len(ARMS)))),
        moved=found.parts,
        alone=found.alone,
        followed=found.followed,
        early=found.early,
        t=t,
        first=a,
        second=b,
        second_after=c,
        asked=(asked(first), asked(second)),
        compared=compared,
        rest=rest,
        axes=tuple(
            axis_difference(
                (*AXES, HEADS)[i],
                median_lag(first, second, found, columns(i)),
                before[compared, i],
                after[compared, i],
                after[rest, i],
            )
            for i in range(len(AXES) + 1)
        ),
        off_set_points=(off_set_points(first, t[rest]), off_set_points(second, seconds[rest])),
        regularity=(regularity(whole[0]), regularity(whole[1])),
        homes=(len(new_homes(whole[0])), len(new_homes(whole[1]))),
    )


def asked(recorded: Recording) -> bool:
    """Return whether a robot accepted a request of a motion, or its requests are unknown."""
    return recorded.requests is None or any(not request.refused for request in recorded.requests)


def columns(row: int) -> tuple[int, ...]:
    """Return the columns from which the lag of a row is calculated: its own, or all of the head for row HEADS."""
    return (row,) if row < len(AXES) else tuple(range(len(ARMS), len(AXES)))


def median_lag(first: Recording, second: Recording, found: Alignment, axes: tuple[int, ...]) -> float:
    """Return the median lag (s) of some axes in all motions whose lag is known; NaN if there are none."""
    one, other = chosen(first, axes), chosen(second, axes)
    lags = []
    for part in found.parts:
        if math.isnan(part.lag_s):
            continue
        shift = best_shift(one, other, window(first, second, part), part.shift_s, LOCAL_S, scaled=True)
        if shift.left < EXPLAINED and not math.isnan(shift.s):
            lags.append(shift.s - (part.lead_s or 0.0))
    return float(np.median(lags)) if lags else math.nan


def axis_difference(axis: str, lag_s: float, before: Floats, after: Floats, still: Floats) -> AxisDifference:
    """Summarise the differences (deg) of one row before and after removal of the lags, and `still` where both rest."""
    if not len(after):
        return AxisDifference(axis, lag_s, *[math.nan] * 6)
    return AxisDifference(
        axis,
        lag_s,
        largest=float(np.max(np.abs(before))),
        rms=float(np.sqrt(np.mean(before**2))),
        largest_after=float(np.max(np.abs(after))),
        rms_after=float(np.sqrt(np.mean(after**2))),
        at_rest=float(np.max(np.abs(still))) if len(still) else math.nan,
        offset=float(np.mean(still)) if len(still) else math.nan,
    )


def differences(first: Floats, second: Floats) -> Floats:
    """Return second minus first in every axis, and the angle between both heads: (n, 7) in deg."""
    head = slice(len(ARMS), len(ARMS) + len(HEAD))
    return np.column_stack([turned(second - first), heads_apart(first[:, head], second[:, head])])


def off_set_points(recorded: Recording, t: Floats) -> float:
    """Return the largest distance of an arm from its set point (deg) at some times; NaN if unknown."""
    if recorded.commanded is None or not len(t):
        return math.nan
    apart = resample(recorded, t)[:, : len(ARMS)] - resample(recorded.arms, t)
    return float(np.max(np.abs(apart)))
