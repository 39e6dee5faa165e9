"""A motion that was tried on a copy of the simulation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from beatrix_zenoh.client.degrees import Path, arm_angles, head_angles
from beatrix_zenoh.client.figures import path_figure
from beatrix_zenoh.client.slips import Suggesting
from beatrix_zenoh.contract._generated.messages import PreviewReply

if TYPE_CHECKING:
    from beatrix_zenoh.client.figures import Figure


@dataclass(frozen=True, repr=False)
class Preview(Suggesting):
    """What a motion would do; the robot has not moved."""

    duration: float
    """time until the arms rest (s)"""
    tilt_max: float
    """largest tilt of the head on the way (deg)"""
    gap_min: float
    """smallest gap between neighbouring arms on the way (deg)"""
    path: Path
    """times (s), arms and head (deg)"""

    def plot(self) -> Figure:
        """Return a figure of the path; raises WrongUsage without the extra `plot`."""
        return path_figure(self.path)

    def __repr__(self) -> str:
        return f"<preview: {self.duration:.1f} s, tilt up to {self.tilt_max:.1f}°, gap at least {self.gap_min:.1f}°>"


def preview_of(reply: PreviewReply) -> Preview:
    """Convert an accepted preview to degrees."""
    return Preview(
        reply.duration,
        math.degrees(reply.tilt_max),
        math.degrees(reply.gap_min),
        Path(reply.t, [arm_angles(arms) for arms in reply.arms], [head_angles(head) for head in reply.head]),
    )
