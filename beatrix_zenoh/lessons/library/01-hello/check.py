import numpy as np

from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.measures import swings

NOD, SHAKE, STILL, HOME = 8, 20, 3, 0.5
NEARLY = 0.5  # the head stops within this angle (deg) of what was asked for


def check(attempt: Attempt) -> None:
    seen = attempt.observe()
    moved = np.abs(seen.head).max()
    attempt.require("moves", moved > 1, moved=moved)
    nods, rolls = swings(seen.pitch, least=2), swings(seen.roll, least=2)
    largest, rolled = max(nods, default=np.ptp(seen.pitch)), max(rolls, default=0.0)
    attempt.require("rolls", largest >= NOD or rolled < NOD, rolled=rolled, largest=largest)
    count = sum(size >= NOD for size in nods)
    attempt.require("nods", count >= 4, count=count, largest=largest)
    sides = np.sign(seen.yaw)[np.abs(seen.yaw) >= SHAKE - NEARLY]
    begins = sides[np.diff(sides, prepend=0.0) != 0]  # each time on a side counts once
    left, right = int((begins > 0).sum()), int((begins < 0).sum())
    attempt.require(
        "shakes", min(left, right) >= 2, left=left, right=right, largest=float(np.abs(seen.yaw).max())
    )
    rolled = np.abs(seen.roll).max()
    attempt.require("roll", rolled < STILL, rolled=rolled)
    left = np.abs(seen.head[-1]).max()
    attempt.require("home", left < HOME, left=left)
    refused = [event for _, event in seen.motions if event.phase == "accepted" and event.reason != "OK"]
    attempt.require("refusal", len(refused) >= 1, count=len(refused))
