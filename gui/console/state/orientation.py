"""The orientation of a head, as the faces show and choose it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class HeadOrientation:
    """Orientation of a head (deg); left, nose down and right ear down are positive."""

    yaw: float
    pitch: float
    roll: float

    @property
    def tenths(self) -> tuple[float, float, float]:
        """Yaw, pitch and roll to a tenth of a degree, less than a pixel."""
        return round(self.yaw, 1) + 0.0, round(self.pitch, 1) + 0.0, round(self.roll, 1) + 0.0
