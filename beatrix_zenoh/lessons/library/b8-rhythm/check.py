"""Check of the lesson about the beat, for blocks."""

from __future__ import annotations

import numpy as np

from beatrix_zenoh.lessons.measures import Curve, swings
from beatrix_zenoh.lessons.phrases import Checked
from beatrix_zenoh.lessons.stage import Seen

NOD, COUNT = 8.0, 8
BEAT_S, OFF = 2.0, 0.1


def check(attempt: Checked) -> None:
    """Require eight nods, beats that are alike, and the right beat."""
    seen = attempt.observe()
    times = downs(seen)
    largest = max(swings(seen.pitch, least=2), default=0.0)
    attempt.require("nods", len(times) >= COUNT, count=len(times), largest=largest)
    beats = np.diff(times)
    period = float(beats.mean())
    shortest, longest = float(beats.min()), float(beats.max())
    alike = max(longest - period, period - shortest) <= OFF * period
    attempt.require("even", alike, shortest=shortest, longest=longest)
    attempt.require("beat", abs(period - BEAT_S) <= OFF * BEAT_S, period=period)


def downs(seen: Seen) -> Curve:
    """Return the times (s) at which the nose passes the middle of a nod on its way down."""
    low, high = seen.pitch.min(), seen.pitch.max()
    if high - low < NOD:
        return np.array([])
    found, waits = [], True
    for t, pitch in zip(seen.t.tolist(), seen.pitch.tolist(), strict=True):
        if waits and pitch > (low + high) / 2:
            found.append(t)
            waits = False
        waits = waits or pitch < (low + high) / 2 - NOD / 4
    return np.array(found)
