import numpy as np

from beatrix_zenoh.contract._generated.messages import Event
from beatrix_zenoh.lessons.attempt import Attempt
from beatrix_zenoh.lessons.measures import swings
from beatrix_zenoh.lessons.picture import Panel

NOD, SHAKE, STILL, HOME = 8, 20, 3, 0.5
ASIDE = 5  # nods turn the head to the side by less (deg)
NEARLY = 0.5  # the head stops within this angle (deg) of what was asked for


def check(attempt: Attempt) -> None:
    attempt.draw = drawn
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
    largest = float(np.abs(seen.yaw).max())
    asked = [event for _, event in seen.motions if event.phase == "accepted"]
    refused = [event for event in asked if event.reason != "OK"]
    skipped = bool(refused) and largest < ASIDE and not any(aside(event) for event in asked)
    attempt.require("skipped", not skipped, largest=largest)
    attempt.require("shakes", min(left, right) >= 2, left=left, right=right, largest=largest)
    rolled = np.abs(seen.roll).max()
    attempt.require("roll", rolled < STILL, rolled=rolled)
    left = np.abs(seen.head[-1]).max()
    attempt.require("home", left < HOME, left=left)
    attempt.require("refusal", len(refused) >= 1, count=len(refused))


def drawn(robots):
    """Return pitch, yaw and roll: how high and low, and how far to the sides they must come."""
    (seen,) = robots.values()
    lowest, inf = min(seen.pitch.min(), 0.0), np.inf
    zones = ((lowest, lowest + 1), (lowest + NOD, inf)), ((-inf, -SHAKE), (SHAKE, inf)), ((-STILL, STILL),)
    return [
        Panel(f"{name} (°)", seen.t, getattr(seen, name), zones=where)
        for name, where in zip(("pitch", "yaw", "roll"), zones, strict=True)
    ]


def aside(event: Event) -> bool:
    """Return whether this request asks the head to look to a side."""
    return event.pose_query is not None and event.pose_query.yaw != 0
