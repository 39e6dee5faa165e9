"""Samples of both robots for the plots: times, memory, differences, and tables of them."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.client import RobotState
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.contract.values import Value, values

Samples = npt.NDArray[np.float64]

SPAN_MAX_S: Final = 60.0
"""Time that is kept."""
CAPACITY: Final = 3072
"""Number of samples kept for each robot: 50 a second for 60 s."""
GAP_S: Final = 1.0
"""A line is interrupted after this time without a sample."""
FOREIGN_S: Final = 1.0
"""If the clock offset is unknown and a stamp is this far from its arrival, the arrival is used instead."""


class History:
    """Samples of one robot in a buffer of constant size: time (s), angles of the arms (deg) and other columns."""

    def __init__(self, columns: Sequence[str] = ARMS) -> None:
        self._rows: Samples = np.empty((CAPACITY, 1 + len(columns)))
        self._columns = [*columns]
        self._count, self._last_s = 0, -math.inf

    def samples(self, now_s: float) -> Samples:
        """Return all samples, oldest first, with times before now."""
        kept = np.roll(self._rows, -self._count, axis=0)[CAPACITY - min(self._count, CAPACITY) :]
        kept[:, 0] -= now_s
        return kept

    def forget(self, column: str) -> None:
        """Clear a column, whose values from now on are another quantity."""
        self._rows[:, 1 + self._columns.index(column)] = math.nan

    def add(self, time_s: float, values: Sequence[float]) -> None:
        """Add a sample if it is newer than the last; a clock set back by more than GAP_S clears the samples."""
        if time_s < self._last_s - GAP_S:
            self._count = 0
        elif time_s <= self._last_s:
            return
        elif self._count and time_s > self._last_s + GAP_S:
            self._put(self._last_s, [math.nan] * len(self._columns))
        self._put(time_s, values)

    def _put(self, time_s: float, values: Sequence[float]) -> None:
        self._rows[self._count % CAPACITY] = (time_s, *values)
        self._count, self._last_s = self._count + 1, time_s


def numbers(state: RobotState) -> dict[str, Value]:
    """Return the numbers in the newest messages of a robot by their field, but no arm angles and no clocks."""
    messages = [message for message in (state.positions, state.status) if message is not None]
    return {
        one.field: one
        for message in messages
        for one in values(message)
        if isinstance(one.value, int | float) and one.unit != "ns" and one.group not in ("", "position")
    }


def sample_time_s(state: RobotState, now_s: float) -> float:
    """Return the time at which positions were measured, by the monotonic clock of this computer (s)."""
    assert state.positions is not None
    stamp_s = state.positions.t_mono_ns / 1e9
    arrived_s = now_s - (state.positions_age_s or 0.0)
    return stamp_s if abs(stamp_s - arrived_s) < FOREIGN_S else arrived_s


def between(rows: Samples, begin_s: float, end_s: float) -> Samples:
    """Return the samples between two times, and the next one on either side, so that lines reach the edges."""
    first = int(np.searchsorted(rows[:, 0], begin_s)) - 1
    last = int(np.searchsorted(rows[:, 0], end_s, side="right"))
    return rows[max(0, first) : last + 1]


def difference(hw: Samples, sim: Samples) -> Samples:
    """Return hardware minus simulation (deg) at the times of the hardware (s), shape (n, 4).

    NaN at times before or after the samples of the simulation; n is 0 if the simulation has fewer than two samples.
    """
    if len(sim) < 2 or len(hw) == 0:
        return np.empty((0, 1 + len(ARMS)))
    apart = hw[:, : 1 + len(ARMS)].copy()
    apart[:, 1:] -= _interpolated(sim[:, : 1 + len(ARMS)], hw[:, 0])
    return apart


def table(samples: Mapping[str, Samples], names: Sequence[str], begin_s: float, end_s: float) -> str:
    """Return the samples between two times as comma-separated text; its header has the names.

    Args:
        samples: by side; a side without samples has no columns.
        names: names of the columns after the time, such as `short_deg`.
        begin_s: time of the first row at the earliest.
        end_s: time of the last row at the latest.

    The rows have the times of the first side that has samples. Values of the other side are interpolated linearly; a
    field is empty where there are none.
    """
    found = {side: rows for side, rows in samples.items() if len(rows)}
    header = ",".join(("time_s", *(f"{side}_{name}" for side in found for name in names)))
    times = next(iter(found.values()))[:, 0] if found else np.empty(0)
    times = times[(times >= begin_s) & (times <= end_s)]
    text = io.StringIO()
    np.savetxt(
        text, np.column_stack((times, *(_interpolated(rows, times) for rows in found.values()))), "%.3f", ","
    )
    return f"{header}\n{text.getvalue().replace('nan', '')}"


def _interpolated(rows: Samples, times: Samples) -> Samples:
    """Return all columns at some times (s), without the time; NaN before the first sample and after the last."""
    columns = [
        np.interp(times, rows[:, 0], column, left=math.nan, right=math.nan) for column in rows[:, 1:].T
    ]
    return np.stack(columns, axis=1)
