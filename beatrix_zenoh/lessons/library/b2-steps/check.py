"""Check of the lesson about one step, for blocks."""

from __future__ import annotations

import numpy as np

from beatrix_zenoh.lessons.phrases import Checked
from beatrix_zenoh.lessons.stage import Seen

STEP = 360 / (1600 * 68 / 26)
ANGLES = range(5, 31, 5)
AS_ASKED, SMALLEST = 0.09, 0.03
REST_S = 0.3
"""Half a second, less what the arm needs to come to rest."""
STILL = 0.5
"""An arm that turns more slowly (deg/s) rests."""


def check(attempt: Checked) -> None:
    """Require one arm, a rest at each angle, and one step more."""
    seen = attempt.observe()
    short, other = np.ptp(seen.arms[:, 0]), np.ptp(seen.arms[:, 1:], axis=0).max()
    attempt.require("moves", short >= 1, moved=short)
    attempt.require("others", other < 0.5, moved=other)
    stops = rests(seen)
    attempt.require("pause", len(stops) >= 3, count=len(stops))
    for asked in ANGLES:
        nearest = min(stops, key=lambda stop: abs(stop - asked))
        attempt.require("angles", abs(nearest - asked) <= AS_ASKED, asked=asked, nearest=nearest)
    last = next((i for i, stop in enumerate(stops) if abs(stop - ANGLES[-1]) <= AS_ASKED / 2), 0)
    moved = stops[last + 1] - stops[last] if last + 1 < len(stops) else 0.0
    attempt.require("smallest", abs(moved - STEP) <= SMALLEST, last=moved)


def rests(seen: Seen) -> list[float]:
    """Return the angles (deg) at which the short arm rests, in their order."""
    moving = np.flatnonzero(np.abs(np.diff(seen.commanded[:, 0])) > STILL * 0.02)
    edges = np.array([-1, *moving, len(seen.t) - 1])
    found = []
    for begin, end in zip(edges[:-1] + 1, edges[1:], strict=True):
        if end > begin and seen.t[end] - seen.t[begin] >= REST_S:
            found.append(float(np.median(seen.commanded[begin : end + 1, 0])))
    return found
