"""Compare two recordings of one movement: leads, lags, differences, and whether these exceed thresholds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from beatrix_zenoh.contract.errors import wrong_usage
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.alignment import Alignment, aligned
from beatrix_zenoh.recording.motion_shifts import LOCAL_S, MovedPart, best_shift, chosen, differ, window
from beatrix_zenoh.recording.requests import Alone
from beatrix_zenoh.recording.series import (
    AXES,
    GRID_S,
    HEAD,
    Flags,
    Floats,
    Recording,
    common_grid,
    heads_apart,
    resample,
    resting,
    sampled,
    turned,
    unbroken,
)

MOST = 2
"""Number of reasons that a sentence gives."""
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
    points were not recorded, without the leads; NaN: unknown, or those of the motions differ"""
    moved: tuple[MovedPart, ...]
    """the motions, each with the lead and the lag of its positions"""
    alone: tuple[Alone, ...]
    """the motions that only one robot carried out; they are no differences"""
    t: Floats
    """times (s)"""
    first: Floats
    """angles (deg) of the first robot, one row per time: arms, then head"""
    second: Floats
    """angles of the second robot, as `first`"""
    second_after: Floats
    """angles of the second robot after removal of each motion's lead and lag, as `first`"""
    robots: tuple[Recording, Recording]
    """the whole recordings"""
    compared: Flags
    """at which times the differences were taken: where both robots were recorded without a gap, and asked for the
    same movement"""
    rest: Flags
    """at which of these times both rest"""
    shared_s: float
    """time (s) that the recordings share"""
    apart_s: float
    """part of this time (s) in which the robots were not asked for the same movement"""
    axes: tuple[AxisDifference, ...]
    """arms, head, and the angle between both heads"""
    off_set_points: tuple[float, float]
    """for each robot, the largest distance of an arm from its set point while both robots rest (deg); NaN: unknown. A
    lost full step is 0.69 deg."""

    @property
    def seconds(self) -> float:
        """Duration (s) of the compared part, the longest part without a hole in either recording."""
        return float(self.t[-1] - self.t[0])

    @property
    def compared_s(self) -> float:
        """Time (s) at which the differences were taken."""
        return float(np.count_nonzero(self.compared)) * GRID_S

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
    comparable = found.comparable(t)
    compared = comparable & (seconds >= second.t[0]) & (seconds <= second.t[-1])
    compared &= sampled(first, t) & sampled(second, seconds)
    rest = resting(a) & resting(c) & compared
    before, after = differences(a, b), differences(a, c)
    return Comparison(
        lag_s=median_lag(first.arms, second.arms, found, tuple(range(len(ARMS)))),
        moved=found.parts,
        alone=found.alone,
        t=t,
        first=a,
        second=b,
        second_after=c,
        robots=whole,
        compared=compared,
        rest=rest,
        apart_s=float(np.count_nonzero(~comparable)) * GRID_S,
        shared_s=float(min(each.t[-1] for each in whole) - max(each.t[0] for each in whole)),
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
        off_set_points=(largest_off(first, t[rest]), largest_off(second, seconds[rest])),
    )


def columns(row: int) -> tuple[int, ...]:
    """Return the columns from which the lag of a row is calculated: its own, or all of the head for row HEADS."""
    return (row,) if row < len(AXES) else tuple(range(len(ARMS), len(AXES)))


def median_lag(first: Recording, second: Recording, found: Alignment, axes: tuple[int, ...]) -> float:
    """Return the median lag (s) of some axes in all motions whose lag is known; NaN if there are none."""
    if differ(found.parts):
        return math.nan
    one, other = chosen(first, axes), chosen(second, axes)
    lags = []
    for part in found.parts:
        if math.isnan(part.lag_s):
            continue
        shift = best_shift(one, other, window(first, second, part), part.shift_s, LOCAL_S)
        if shift.explains:
            lags.append(shift.s - (part.lead_s or 0.0))
    return float(np.median(lags)) if lags else math.nan


def axis_difference(axis: str, lag_s: float, before: Floats, after: Floats, still: Floats) -> AxisDifference:
    """Summarise the differences (deg) of one row before and after removal of the lags, and `still` where both rest."""
    return AxisDifference(
        axis,
        lag_s,
        largest=largest(before),
        rms=mean(before**2) ** 0.5,
        largest_after=largest(after),
        rms_after=mean(after**2) ** 0.5,
        at_rest=largest(still),
        offset=mean(still),
    )


def largest(values: Floats) -> float:
    """Return the largest amount; NaN if there are no values."""
    return float(np.max(np.abs(values))) if values.size else math.nan


def mean(values: Floats) -> float:
    """Return the mean; NaN if there are no values."""
    return float(np.mean(values)) if values.size else math.nan


def differences(first: Floats, second: Floats) -> Floats:
    """Return second minus first in every axis, and the angle between both heads: (n, 7) in deg."""
    head = slice(len(ARMS), len(ARMS) + len(HEAD))
    return np.column_stack([turned(second - first), heads_apart(first[:, head], second[:, head])])


def largest_off(recorded: Recording, t: Floats) -> float:
    """Return the largest distance of an arm from its set point (deg) at some times; NaN if unknown."""
    if recorded.commanded is None:
        return math.nan
    return largest(resample(recorded, t)[:, : len(ARMS)] - resample(recorded.arms, t))


@dataclass(frozen=True)
class Thresholds:
    """The largest allowed values; None: not checked."""

    lag_s: float | None = None
    """largest lag of the set points, of either robot behind the other, without the lead"""
    rms_deg: float | None = None
    """largest root mean square difference of an axis after removal of each motion's lead and lag"""
    largest_deg: float | None = None
    """largest difference of an axis after removal of each motion's lead and lag"""
    rest_deg: float | None = None
    """largest difference of an axis while both robots rest"""
    missed_steps: int | None = None
    """full motor steps that slipped in the simulation"""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not (math.isfinite(value) and value >= 0):
                raise wrong_usage(f"{name} is {value:g}: give a number, 0 or more.")

    def exceeded(self, found: Comparison) -> list[str]:
        """Return a sentence for each threshold that is exceeded or cannot be checked."""
        return [*self._lag(found), *self._axes(found), *self._missed(found.robots[0].slipped)]

    def _lag(self, found: Comparison) -> Iterator[str]:
        if self.lag_s is None:
            return
        unknown = sum(1 for part in found.moved if part.why)
        if math.isnan(found.lag_s) or 2 * unknown >= len(found.moved):
            yield f"At most {self.lag_s:g} s of lag is allowed, but the lag is not known: {why_no_lag(found)}"
        elif abs(found.lag_s) > self.lag_s:
            yield f"The lag is {found.lag_s:+.5g} s; at most {self.lag_s:g} s in either direction is allowed."

    def _axes(self, found: Comparison) -> Iterator[str]:
        limited = any(limit is not None for limit in (self.rms_deg, self.largest_deg, self.rest_deg))
        expected_s = max((found.shared_s - found.apart_s) / 2, found.shared_s / 4)
        if limited and found.compared_s < expected_s:
            yield (
                f"Only {found.compared_s:.1f} s of {found.shared_s:.1f} s could be compared, so the differences are not "
                "known: record both robots without gaps, and move both together."
            )
            return
        for what, field, allowed in (
            ("rms difference after removal of lead and lag", "rms_after", self.rms_deg),
            ("largest difference after removal of lead and lag", "largest_after", self.largest_deg),
            ("difference at rest", "at_rest", self.rest_deg),
        ):
            if allowed is None:
                continue
            values = {axis.axis: float(getattr(axis, field)) for axis in found.axes}
            worst = max(values, key=lambda axis: (math.isnan(values[axis]), values[axis]))
            if math.isnan(values[worst]):
                yield (
                    f"At most {allowed:g}° of {what} is allowed, but it is not known: let both robots rest at the same time for "
                    "a second."
                )
            elif values[worst] > allowed:
                yield f"The {what} is {values[worst]:.5g}° in {worst}; at most {allowed:g}° is allowed."

    def _missed(self, slipped: int | None) -> Iterator[str]:
        if self.missed_steps is None:
            return
        if slipped is None:
            yield (
                f"At most {self.missed_steps} missed steps are allowed, but this source does not measure them: "
                "only a live simulation does."
            )
        elif abs(slipped) > self.missed_steps:
            yield f"The simulation missed {abs(slipped)} full steps; at most {self.missed_steps} are allowed."


def why_no_lag(found: Comparison) -> str:
    """Return the reason why no lag was measured, as the end of a sentence."""
    if not found.anything_moved:
        return "nothing moved. Move both robots during the comparison."
    if not found.moved:
        return "no motion was made by both robots. Move both during the comparison."
    if differ(found.moved):
        lags_ms = [part.lag_s * 1e3 for part in found.moved if not math.isnan(part.lag_s)]
        return f"the lags of the motions differ, from {min(lags_ms):z.0f} to {max(lags_ms):z.0f} ms."
    reasons = list(dict.fromkeys(part.why for part in found.moved if part.why))
    return f"{'; '.join(reasons[:MOST]) or 'the set points of the two robots do not agree'}."
