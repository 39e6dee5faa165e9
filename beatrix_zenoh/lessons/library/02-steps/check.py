import math
from itertools import pairwise

import numpy as np

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt, Seen

TURN = 200 * 8 * 68 / 26
STEP = 360 / TURN
ANGLES = range(3, 31, 3)
AS_ASKED, SMALLEST = 0.09, 0.01
REST_S = 0.1  # an arm that has arrived swings for less


def check(attempt: Attempt) -> None:
    turn = attempt.call("steps_per_turn")
    attempt.require("gear", abs(turn - 1600) > 1, value=turn)
    attempt.require("upside-down", abs(turn - 1600 * 26 / 68) > 1, value=turn)
    attempt.require("turn", abs(turn - TURN) < 0.1, value=turn)
    step = attempt.call("degrees_per_step")
    slips.numbers("degrees_per_step", step, STEP, 0.001)
    attempt.require("step", abs(step - STEP) < 0.001, value=step)
    for degrees in (1, 10, 29.99, 45, -10):
        steps = attempt.call("steps_for", degrees)
        attempt.require("whole", math.isfinite(steps) and steps == int(steps), degrees=degrees, steps=steps)
        away = abs(steps * STEP - degrees)
        attempt.require("nearest", away <= STEP / 2, degrees=degrees, steps=steps, exact=degrees / STEP)
    degrees = attempt.call("degrees_for", 116)
    slips.numbers("degrees_for", degrees, 116 * STEP, 0.01)
    attempt.require("back", abs(degrees - 116 * STEP) < 0.01, value=degrees)
    seen = attempt.observe()
    own = [(time, event.phase) for time, event in seen.motions]
    rests = [
        (begin, end) for (begin, phase), (end, _) in pairwise([*own, (seen.t[-1], "")]) if phase == "done"
    ]
    rest = min((end - begin for begin, end in rests), default=REST_S)
    stops = [resting(seen, begin, end) for begin, end in rests]
    for asked in ANGLES:
        nearest = min(stops, key=lambda stop: abs(stop - asked), default=0.0)
        near = abs(nearest - asked) < AS_ASKED
        attempt.require("pause", near or rest >= REST_S, rest=rest)
        attempt.require("angles", near, asked=asked, nearest=nearest)
    moves = [abs(b - a) for a, b in pairwise(stops) if abs(b - a) > STEP / 2]
    smallest = min(moves, default=0.0)
    near = abs(smallest - STEP) < SMALLEST
    attempt.require("pause", near or rest >= REST_S, rest=rest)
    attempt.require("smallest", near, smallest=smallest)


def resting(seen: Seen, begin: float, end: float) -> float:
    """Return the angle (deg) of the short arm between the end of a motion and the next one, the median of the readings."""
    inside = (seen.t >= begin + 0.02) & (seen.t <= end - 0.02)
    return float(
        np.median(seen.arms[:, 0][inside]) if inside.any() else np.interp(end, seen.t, seen.arms[:, 0])
    )
