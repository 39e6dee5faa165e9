"""Compare two recordings of one movement: differences and lag."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from beatrix_zenoh.recording.lag import MovedPart, lag, moved_parts, without_lag
from beatrix_zenoh.recording.series import (
    ARMS,
    AXES,
    HEAD,
    Flags,
    Floats,
    Recording,
    Regularity,
    common_grid,
    heads_apart,
    regularity,
    resample,
    resting,
    turned,
    unbroken,
)

HEADS = "head"
"""Name of the last row: the angle between both heads."""


@dataclass(frozen=True)
class AxisDifference:
    """Differences (deg) and lag (s) between two robots in one axis, or between their heads."""

    axis: str
    lag_s: float
    """lag of the second robot behind the first; NaN: the axis did not move, or no lag explains the difference"""
    largest: float
    rms: float
    largest_after: float
    """largest difference after removal of each motion's lag"""
    rms_after: float
    at_rest: float
    """largest difference while both rest; NaN: they never rest at the same time"""
    offset: float
    """mean of second minus first while both rest; NaN: they never rest at the same time"""


@dataclass(frozen=True)
class Comparison:
    """The comparison of a second recording with a first, on a common grid of times."""

    lag_s: float
    """lag (s) of the set points of the second robot behind those of the first, or of its positions if its set points
    were not recorded; NaN if nothing moved, or no lag explains the differences"""
    moved: tuple[MovedPart, ...]
    """the motions, each with the lag of its positions"""
    t: Floats
    """times (s)"""
    first: Floats
    """angles (deg) of the first robot, one row per time: arms, then head"""
    second: Floats
    """angles of the second robot, as `first`"""
    second_after: Floats
    """angles of the second robot after removal of each motion's lag, as `first`"""
    axes: tuple[AxisDifference, ...]
    """arms, head, and the angle between both heads"""
    off_set_points: tuple[float, float]
    """for each robot, the largest distance of an arm from its set point while both robots rest (deg); NaN: unknown. A
    lost full step is 0.69 deg."""
    regularity: tuple[Regularity, Regularity]

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
        return not (resting(self.first) & resting(self.second)).all()


def compare(first: Recording, second: Recording) -> Comparison:
    """Compare two recordings over the longest common part without a hole; both must have times of one clock.

    Raises:
        ValueError: that part is shorter than a second, or a recording has fewer than two positions.
    """
    whole = first, second
    first, second = unbroken(first, second)
    t = common_grid(first, second)
    whole_s = lag(first, second)
    parts = [] if math.isnan(whole_s) else moved_parts(first, second, whole_s)
    shift_s = 0.0 if math.isnan(whole_s) else whole_s
    kept = t[(t + shift_s >= second.t[0]) & (t + shift_s <= second.t[-1])]
    a, b = resample(first, t), resample(second, t)
    before, rest = differences(a, b), resting(a) & resting(b)
    after = differences(resample(first, kept), without_lag(second, kept, shift_s, parts))
    return Comparison(
        lag_s=lag(first.arms, second.arms),
        moved=tuple(parts),
        t=t,
        first=a,
        second=b,
        second_after=without_lag(second, t, shift_s, parts),
        axes=tuple(
            axis_difference(i, lag(first, second, columns(i)), before[:, i], after[:, i], rest)
            for i in range(len(AXES) + 1)
        ),
        off_set_points=(off_set_points(first, t, rest), off_set_points(second, t, rest)),
        regularity=(regularity(whole[0]), regularity(whole[1])),
    )


def columns(row: int) -> tuple[int, ...]:
    """Return the columns from which the lag of a row is calculated: its own, or all of the head for row HEADS."""
    return (row,) if row < len(AXES) else tuple(range(len(ARMS), len(AXES)))


def axis_difference(row: int, lag_s: float, before: Floats, after: Floats, rest: Flags) -> AxisDifference:
    """Summarise the differences (deg) of one row before and after removal of the lags."""
    still = before[rest]
    return AxisDifference(
        (*AXES, HEADS)[row],
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


def off_set_points(recorded: Recording, t: Floats, rest: Flags) -> float:
    """Return the largest distance of an arm from its set point (deg) where `rest` is true; NaN if unknown."""
    if recorded.commanded is None or not rest.any():
        return math.nan
    apart = resample(recorded, t)[:, : len(ARMS)] - resample(recorded.arms, t)
    return float(np.max(np.abs(apart[rest])))
