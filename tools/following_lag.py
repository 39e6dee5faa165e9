"""The lag of a simulation that follows, computed from the time stamps of both robots' positions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.contract._generated.messages import Positions

Series = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
"""Times (s), and the angles (deg) of the three arms at them."""
LARGEST_DEG = 1.0
SHIFTS_S = np.arange(-0.05, 0.3, 0.001)


def series(positions: Sequence[Positions], field: str = "position") -> Series:
    """Return the times and arm angles of published positions, in the order of the times."""
    kept = {one.t_mono_ns: getattr(one, field) for one in positions}
    times = sorted(kept)
    angles = [[kept[time].x, kept[time].y, kept[time].z] for time in times]
    return np.array(times) / 1e9, np.degrees(np.array(angles))


def lag_s(hardware: Series, simulation: Series) -> tuple[float, float]:
    """Return the lag (s) of the simulation that leaves the smallest difference, and that difference (deg, mean).

    A difference counts as at most LARGEST_DEG, so that a pause of the computer does not change the lag.
    """
    times, angles = hardware
    inside = (times > simulation[0][0] + 0.35) & (times < simulation[0][-1] - 0.35)
    left = [
        float(
            np.mean(np.minimum(np.abs(_at(simulation, times[inside] + shift) - angles[inside]), LARGEST_DEG))
        )
        for shift in SHIFTS_S
    ]
    best = int(np.argmin(left))
    return float(SHIFTS_S[best]), left[best]


def largest_step_deg(positions: Sequence[Positions]) -> float:
    """Return the largest change (deg) of a set point between two samples, for each 20 ms between them."""
    times, angles = series(positions, "commanded")
    periods = np.maximum(1.0, np.diff(times) / 0.02)
    return float(np.max(np.abs(np.diff(angles, axis=0)) / periods[:, None]))


def _at(one: Series, times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.column_stack([np.interp(times, one[0], one[1][:, arm]) for arm in range(3)])
