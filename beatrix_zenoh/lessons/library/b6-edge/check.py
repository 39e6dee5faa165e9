"""Check of the lesson about the edge, for blocks."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import Phase, Reason
from beatrix_zenoh.lessons.measures import largest_tilt
from beatrix_zenoh.lessons.phrases import Checked

LEAN = 33.0
BESIDE_DEG = 12.0


def check(attempt: Checked) -> None:
    """Require five directions, and no refusal."""
    seen = attempt.observe()
    refused = [e for _, e in seen.motions if e.phase is Phase.ACCEPTED and e.reason is not Reason.OK]
    attempt.require("refused_motions", not refused, count=len(refused))
    down, up = largest_tilt(seen, 0, BESIDE_DEG), largest_tilt(seen, 180, BESIDE_DEG)
    attempt.require("nose", min(down, up) >= LEAN, down=down, up=up)
    right, left = largest_tilt(seen, 90, BESIDE_DEG), largest_tilt(seen, -90, BESIDE_DEG)
    attempt.require("ears", min(right, left) >= LEAN, right=right, left=left)
    between = largest_tilt(seen, 45, BESIDE_DEG)
    attempt.require("between", between >= LEAN, tilt=between)
