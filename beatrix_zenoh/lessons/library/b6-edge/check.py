"""Check of the lesson about the edge, for blocks."""

from __future__ import annotations

import numpy as np

from beatrix_zenoh.contract._generated.messages import Phase, Reason
from beatrix_zenoh.lessons.phrases import Checked
from beatrix_zenoh.lessons.stage import Seen

LEAN = 33.0
BESIDE_DEG = 12.0


def check(attempt: Checked) -> None:
    """Require five directions, and no refusal."""
    seen = attempt.observe()
    refused = [e for _, e in seen.motions if e.phase is Phase.ACCEPTED and e.reason is not Reason.OK]
    attempt.require("refused_motions", not refused, count=len(refused))
    down, up = largest(seen, 0), largest(seen, 180)
    attempt.require("nose", min(down, up) >= LEAN, down=down, up=up)
    right, left = largest(seen, 90), largest(seen, -90)
    attempt.require("ears", min(right, left) >= LEAN, right=right, left=left)
    between = largest(seen, 45)
    attempt.require("between", between >= LEAN, tilt=between)


def largest(seen: Seen, direction: float) -> float:
    """Return the largest tilt (deg) of the head with its lowest side in a direction (deg): 0 nose, 90 right ear."""
    pitch, roll = np.radians(seen.pitch), np.radians(seen.roll)
    nose, ear = np.sin(pitch), np.cos(pitch) * np.sin(roll)
    tilt = np.degrees(np.arctan2(np.hypot(nose, ear), np.cos(pitch) * np.cos(roll)))
    beside = (np.degrees(np.arctan2(ear, nose)) - direction + 180) % 360 - 180
    return float(tilt[np.abs(beside) <= BESIDE_DEG].max(initial=0.0))
