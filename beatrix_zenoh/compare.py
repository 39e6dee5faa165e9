"""Two recordings of one movement: how far apart, and which is behind."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from beatrix_zenoh._generated.messages import Positions
from beatrix_zenoh.readings import reading

Floats = npt.NDArray[np.float64]

ARMS = ("short", "middle", "long")
AXES = (*ARMS, "yaw", "pitch", "roll")
GRID_S = 0.01
"""Positions come every 20 ms; half of that loses nothing."""
LAG_MAX_S = 0.5
STEP_FINE_S = 0.001
REST_S = 0.1
"""A robot is at rest where for this long before and after no arm turned"""
REST_DEG = 0.3
"""by more than this."""


@dataclass(frozen=True)
class Recording:
    """Positions over time: t (n,) in s, angles (n, 6) in deg in the order of AXES."""

    t: Floats
    angles: Floats


@dataclass(frozen=True)
class AxisDifference:
    """How far two robots are apart in one axis, deg."""

    axis: str
    largest: float
    rms: float
    at_rest: float
    """largest while both rest; NaN if they never do"""


@dataclass(frozen=True)
class Comparison:
    """A second recording against a first, on a common grid."""

    lag_s: float
    """by which the second is behind the first; NaN if nothing moved"""
    t: Floats
    first: Floats
    second: Floats
    axes: tuple[AxisDifference, ...]

    @property
    def arms_at_rest(self) -> float:
        """Largest difference of any arm while both rest, deg; NaN if they never do."""
        return max(axis.at_rest for axis in self.axes[: len(ARMS)])


def recording(positions: Sequence[Positions]) -> Recording:
    """Positions as they were published, in degrees, over the source's monotonic clock."""
    readings = [reading(each) for each in positions]
    angles = np.array([(*r.arms, *r.head) for r in readings], dtype=np.float64).reshape(-1, len(AXES))
    return Recording(
        np.array([r.t for r in readings], dtype=np.float64), np.unwrap(angles, period=360, axis=0)
    )


def compare(first: Recording, second: Recording) -> Comparison:
    """Differences and lag where both were recorded; their clocks must agree.

    Raises:
        ValueError: they share less than a second.
    """
    t = common_grid(first, second)
    a, b = resample(first, t), resample(second, t)
    apart, rest = turned(b - a), resting(a) & resting(b)
    axes = tuple(
        AxisDifference(
            axis,
            largest=float(np.max(np.abs(apart[:, i]))),
            rms=float(np.sqrt(np.mean(apart[:, i] ** 2))),
            at_rest=float(np.max(np.abs(apart[rest, i]))) if rest.any() else math.nan,
        )
        for i, axis in enumerate(AXES)
    )
    return Comparison(lag(first, second), t, a, b, axes)


def common_grid(first: Recording, second: Recording) -> Floats:
    """Times every 10 ms at which both were recorded; raises as `compare`."""
    if min(len(first.t), len(second.t)) < 2:
        raise ValueError("a recording with fewer than two positions cannot be compared")
    begin, end = max(first.t[0], second.t[0]), min(first.t[-1], second.t[-1])
    if end - begin < 1.0:
        raise ValueError(f"the recordings share {max(0.0, end - begin):.2f} s; a second is needed")
    return np.asarray(np.arange(begin, end, GRID_S), dtype=np.float64)


def resample(recorded: Recording, t: Floats) -> Floats:
    """Angles (n, 6) at other times, linearly between positions."""
    return np.column_stack([np.interp(t, recorded.t, column) for column in recorded.angles.T])


def lag(first: Recording, second: Recording) -> float:
    """Seconds by which the second is behind the first, up to half a second; NaN if nothing moved.

    The shift with the least sum of squared differences of the arms: in steps of the grid, then of
    1 ms, then at the vertex of the parabola through the best three.
    """
    t = common_grid(first, second)
    limit = min(LAG_MAX_S, (t[-1] - t[0]) / 4)
    inner = t[(t >= t[0] + limit) & (t <= t[-1] - limit)]
    still = resample(first, inner)[:, : len(ARMS)]
    if np.max(np.ptp(still, axis=0)) < REST_DEG:
        return math.nan

    def apart(shift: float) -> float:
        return float(np.sum((resample(second, inner + shift)[:, : len(ARMS)] - still) ** 2))

    count = int(limit / GRID_S) - 1
    coarse = min((i * GRID_S for i in range(-count, count + 1)), key=apart)
    shifts = [coarse + i * STEP_FINE_S for i in range(-11, 12)]
    costs = [apart(shift) for shift in shifts]
    best = min(range(1, len(shifts) - 1), key=lambda i: costs[i])
    before, at, after = costs[best - 1 : best + 2]
    curvature = before - 2 * at + after
    return shifts[best] + (STEP_FINE_S * (before - after) / (2 * curvature) if curvature > 0 else 0.0)


def resting(angles: Floats) -> npt.NDArray[np.bool_]:
    """Where on the grid the arms rest."""
    window = int(REST_S / GRID_S)
    padded = np.pad(angles[:, : len(ARMS)], ((window, window), (0, 0)), mode="edge")
    views = np.lib.stride_tricks.sliding_window_view(padded, 2 * window + 1, axis=0)
    return np.asarray(np.max(np.ptp(views, axis=-1), axis=-1) < REST_DEG, dtype=np.bool_)


def turned(difference: Floats) -> Floats:
    """Differences of angles within half a turn: 359 deg apart is 1 deg apart."""
    return np.asarray((difference + 180.0) % 360.0 - 180.0, dtype=np.float64)
