"""Measures that several lessons share: swings and errors of sampled curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Curve = npt.NDArray[np.float64]
"""Samples of a quantity, shape (n,)."""


@dataclass(frozen=True)
class HeadCurves:
    """What a head did: times (s), and angles (deg)."""

    t: Curve
    head: Curve
    """shape (n, 3): yaw, pitch, roll"""
    arms: Curve
    """shape (n, 3): short, middle, long"""

    @property
    def yaw(self) -> Curve:
        """Yaw of the head (deg)."""
        return self.head[:, 0]

    @property
    def pitch(self) -> Curve:
        """Pitch of the head (deg)."""
        return self.head[:, 1]

    @property
    def roll(self) -> Curve:
        """Roll of the head (deg)."""
        return self.head[:, 2]


def largest_tilt(seen: HeadCurves, direction: float, beside: float) -> float:
    """Return the largest tilt (deg) of the head with its lowest side in a direction, at most `beside` (deg) away from it.

    direction: in deg, 0 nose, 90 right ear.
    """
    pitch, roll = np.radians(seen.pitch), np.radians(seen.roll)
    nose, ear = np.sin(pitch), np.cos(pitch) * np.sin(roll)
    tilt = np.degrees(np.arctan2(np.hypot(nose, ear), np.cos(pitch) * np.cos(roll)))
    away = (np.degrees(np.arctan2(ear, nose)) - direction + 180) % 360 - 180
    return float(tilt[np.abs(away) <= beside].max(initial=0.0))


def swings(values: Curve, least: float) -> list[float]:
    """Return the sizes of the movements between turning points, in order, those below `least` left out.

    A nod that goes down and up again is two swings. A curve that turns back by less than `least` does not turn.
    """
    if not len(values):
        return []
    found: list[float] = []
    low = high = begin = end = float(values[0])
    direction = 0
    for value in values.tolist():
        if direction == 0:
            low, high = min(low, value), max(high, value)
            if high - low >= least:
                direction = 1 if value == high else -1
                begin, end = (low, high) if direction > 0 else (high, low)
        elif direction * (value - end) >= 0:
            end = value
        elif abs(value - end) >= least:
            found.append(abs(end - begin))
            begin, end, direction = end, value, -direction
    if direction:
        found.append(abs(end - begin))
    return found


def rms(values: npt.ArrayLike) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(np.asarray(values, dtype=float)))))
