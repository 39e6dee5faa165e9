import numpy as np

from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.measures import swings

NOD, SHAKE, STILL, HOME = 8, 20, 3, 0.5


def check(attempt: Attempt) -> None:
    seen = attempt.observe()
    moved = np.abs(seen.head).max()
    attempt.require("moves", moved > 1, moved=moved)
    nods, rolls = swings(seen.pitch, least=2), swings(seen.roll, least=2)
    largest, rolled = max(nods, default=np.ptp(seen.pitch)), max(rolls, default=0.0)
    attempt.require("rolls", largest >= NOD or rolled < NOD, rolled=rolled, largest=largest)
    count = sum(size >= NOD for size in nods)
    attempt.require("nods", count >= 4, count=count, largest=largest)
    shakes = swings(seen.yaw, least=2)
    count = sum(size >= SHAKE for size in shakes)
    attempt.require("shakes", count >= 4, count=count, largest=max(shakes, default=0.0))
    rolled = np.abs(seen.roll).max()
    attempt.require("roll", rolled < STILL, rolled=rolled)
    left = np.abs(seen.head[-1]).max()
    attempt.require("home", left < HOME, left=left)
    refused = [event for event in seen.events if event.reason not in ("OK", "") and event.seat == "pupil"]
    attempt.require("refusal", len(refused) >= 1, count=len(refused))
