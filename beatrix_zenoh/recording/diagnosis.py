"""What a comparison shows about its cause: findings as data and as sentences, at most one for each effect."""

from __future__ import annotations

import itertools
import math
from typing import Final, NamedTuple

import numpy as np

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.finding import (
    Cause,
    Finding,
    clocks,
    count,
    following,
    listed,
    lost_samples,
    new_homes,
    not_asked,
    stopped,
)
from beatrix_zenoh.recording.series import Flags, Floats, runs

FULL_STEP_DEG: Final = 360 / ROBOT.drive.full_steps * ROBOT.drive.gear_pinion / ROBOT.drive.gear_ring
APART_DEG: Final = 0.25
"""A smaller difference of an arm has no cause that is worth a sentence: noise, and motors that behave like springs."""
BEGAN_DEG: Final = 1.0
"""Robots that begin further apart began in different poses."""
CLEAR_DEG: Final = 3.0
"""An arm is judged if it turns by more than this."""
STILL_DEG: Final = 1.0
"""An arm that turns by less than this stands still."""
UNLIKE: Final = 0.05
"""Arms are exchanged or reversed if the movement as it is leaves more than this share of the variance."""
BETTER: Final = 0.2
"""A cause explains the differences if it leaves less than this share of them."""
SCALE: Final = 0.01
"""Smallest error of scale that is reported."""
SCALES: Final = -0.6, 1.5
"""Errors of scale that are reported: beyond them the robots make different movements."""
AFTER_S: Final = 1.0
"""The other robot must move later than this (s) after an arm stood still."""
MOTIONS: Final = 2
"""Number of motions during which an arm must stand still: a single one may be late."""
REST_S: Final = 0.2
"""Rests that are shorter than this (s) are not looked at."""

Mapped = tuple[tuple[int, ...], tuple[int, ...]]
"""For each arm of the first robot the index of an arm of the second, and its sign."""


class ComparedSamples(NamedTuple):
    """Samples of both robots at times that can be compared: n rows, arms in deg."""

    t: Floats
    first: Floats
    second: Floats
    rest: Flags


def findings(found: Comparison) -> list[Finding]:
    """Return what the comparison shows, the most important first."""
    result = [*lost_samples(found), *new_homes(found), *following(found)]
    result += [*not_asked(found), *stopped(found)]
    seen = samples(found)
    if not len(seen.t) or not found.anything_moved:
        return result
    if still := stood_still(found, seen) or stopped_moving(found, seen):
        return [*result, *still]
    began = began_apart(found, seen)
    if began is not None:
        result.append(began)
        seen = after(seen, began.t)
        if len(seen.t) < 2:
            return result
    swapped = exchanged(seen)
    if swapped:
        return [*result, *swapped]
    return [*result, *arm_by_arm(seen), *clocks(found)]


def samples(found: Comparison) -> ComparedSamples:
    """Return the samples of the arms that can be compared."""
    arms = slice(0, len(ARMS))
    finite = np.isfinite(np.hstack([found.first, found.second_after])).all(axis=1)
    kept = found.compared & finite
    return ComparedSamples(
        found.t[kept] - found.t[0],
        found.first[kept, arms],
        found.second_after[kept, arms],
        found.rest[kept],
    )


def after(seen: ComparedSamples, t: float) -> ComparedSamples:
    """Return the samples after a time (s)."""
    kept = seen.t > t
    return ComparedSamples(seen.t[kept], seen.first[kept], seen.second[kept], seen.rest[kept])


def stood_still(found: Comparison, seen: ComparedSamples) -> list[Finding]:
    """Return a finding if one robot was asked to move, and stood still while the other moved."""
    if not found.moved:
        return []
    ways = np.ptp(seen.first, axis=0), np.ptp(seen.second, axis=0)
    for name, i in (("hardware", 1), ("simulation", 0)):
        if found.asked[i] and ways[i].max() < STILL_DEG and ways[1 - i].max() > CLEAR_DEG:
            return [Finding(Cause.STOOD_STILL, f"The {name} stood still: check its motors, power and STOP.")]
    return []


def stopped_moving(found: Comparison, seen: ComparedSamples) -> list[Finding]:
    """Return findings for arms of the hardware that moved, and then stood still during all later motions."""
    since: dict[str, float] = {}
    for i, arm in enumerate(ARMS):
        away = np.flatnonzero(np.abs(seen.second[:, i] - np.median(seen.second[-20:, i])) > STILL_DEG)
        if not len(away):
            continue
        t = float(seen.t[away[-1]])
        later = [part for part in found.moved if part.begin_s - found.t[0] > t and not part.measured]
        way = seen.first[seen.t > t + AFTER_S, i]
        if len(later) >= MOTIONS and len(way) and np.ptp(way) > CLEAR_DEG:
            since[arm] = t
    if len(since) == len(ARMS):
        t = max(since.values())
        sentence = f"The hardware stands still from {t:.1f} s on: check its motors, power and STOP."
        return [Finding(Cause.STOOD_STILL, sentence, t=t)]
    return [
        Finding(
            Cause.STOOD_STILL,
            f"{arm.capitalize()} stands still on the hardware from {t:.1f} s on: check its motor.",
            (arm,),
            t=t,
        )
        for arm, t in since.items()
    ]


def began_apart(found: Comparison, seen: ComparedSamples) -> Finding | None:
    """Return a finding if the robots began in different poses and came together later."""
    spans = rests(seen)
    if not spans or not len(found.moved):
        return None
    means = [np.mean(seen.second[a:b] - seen.first[a:b], axis=0) for a, b in spans]
    first = means[0]
    gone = [i for i in range(len(ARMS)) if abs(first[i]) > BEGAN_DEG]
    together = [k for k, each in enumerate(means) if all(abs(each[i]) < abs(first[i]) / 2 for i in gone)]
    if not gone or not together or seen.t[spans[0][0]] > found.moved[0].begin_s - found.t[0]:
        return None
    largest = max((float(first[i]) for i in gone), key=abs)
    arms = tuple(ARMS[i] for i in gone)
    return Finding(
        Cause.BEGAN_APART,
        f"They began {abs(largest):.1f}° apart in {listed(arms)}: move both home first.",
        arms,
        largest,
        float(seen.t[spans[together[0]][0]]),
    )


def rests(seen: ComparedSamples) -> list[tuple[int, int]]:
    """Return begin and end (exclusive) of each rest of both robots, without short ones."""
    return [(a, b) for a, b in runs(seen.rest) if seen.t[b - 1] - seen.t[a] > REST_S]


def exchanged(seen: ComparedSamples) -> list[Finding]:
    """Return findings if other arms, or reversed ones, explain the movement of the second much better."""
    one, other = (angles - angles.mean(axis=0) for angles in (seen.first, seen.second))
    total = float(np.sum(one**2))
    as_it_is = float(np.sum((one - other) ** 2))
    if total == 0 or as_it_is < UNLIKE * total:
        return []
    trials = itertools.product(itertools.permutations(range(3)), itertools.product((1, -1), repeat=3))

    def cost(trial: Mapped) -> float:
        """Return the sum of squares that a trial leaves, a little more for each arm that it changes."""
        order, signs = trial
        left = float(np.sum((one - other[:, list(order)] * np.array(signs)) ** 2))
        return left + 1e-3 * total * (sum(i != j for i, j in enumerate(order)) + signs.count(-1))

    order, signs = best = min(trials, key=cost)
    if cost(best) > BETTER * as_it_is:
        return []
    result = []
    moved = [i for i, j in enumerate(order) if i != j]
    if moved:
        arms = tuple(ARMS[i] for i in moved)
        result.append(
            Finding(
                Cause.EXCHANGED,
                f"{listed(arms).capitalize()} look exchanged: check the plugs of the motors.",
                arms,
            )
        )
    turned = tuple(ARMS[j] for j, sign in zip(order, signs, strict=True) if sign < 0)
    if turned:
        verb = "turns" if len(turned) == 1 else "turn"
        result.append(
            Finding(
                Cause.REVERSED,
                f"{listed(turned).capitalize()} {verb} the other way: check the wiring of the motor{'s' * (len(turned) > 1)}.",
                turned,
            )
        )
    return result


def arm_by_arm(seen: ComparedSamples) -> list[Finding]:
    """Return the cause of the differences of each arm; a scale that all arms share is one finding."""
    each = [cause_of(seen, i) for i in range(len(ARMS))]
    result = [finding for finding in each if finding is not None]
    scales = [finding for finding in result if finding.cause is Cause.SCALE]
    if len(scales) == len(ARMS) and np.ptp([finding.value for finding in scales]) < SCALE:
        return [scale(ARMS, float(np.mean([finding.value for finding in scales])))]
    return result


def cause_of(seen: ComparedSamples, arm: int) -> Finding | None:
    """Return why one arm differs: it stands still, has an offset, moves too far, or has missed steps; None: unknown."""
    name = ARMS[arm]
    mine, other = seen.first[:, arm], seen.second[:, arm]
    if np.ptp(mine) > CLEAR_DEG and np.ptp(other) < STILL_DEG:
        return Finding(
            Cause.STOOD_STILL, f"{name.capitalize()} stood still on the hardware: check its motor.", (name,)
        )
    apart = other - mine
    constant = float(np.mean(apart[seen.rest])) if seen.rest.any() else float(np.mean(apart))
    around = apart - apart.mean()
    spread = float(np.sum(around**2))
    slope, left_scale = scaled(mine, around)
    step, at, left_step = stepped(seen, apart)
    if (
        abs(slope) > SCALE
        and SCALES[0] <= slope <= SCALES[1]
        and abs(slope) * float(np.ptp(mine)) > 2 * APART_DEG
        and left_scale < min(2 * BETTER * spread, left_step)
    ):
        return scale((name,), slope)
    steps = round(step / FULL_STEP_DEG)
    spans = rests(seen)
    around_step = any(seen.t[b - 1] <= at for _, b in spans) and any(seen.t[a] >= at for a, _ in spans)
    if (
        steps
        and around_step
        and left_step < 2 * BETTER * spread
        and abs(step - steps * FULL_STEP_DEG) < APART_DEG
    ):
        missed = count(abs(steps), "full step")
        return Finding(
            Cause.MISSED_STEPS,
            f"{name.capitalize()} is {step:+.2f}° off from {at:.1f} s on, {missed}: it missed steps. Move home and calibrate.",
            (name,),
            float(steps),
            at,
        )
    varies = float(np.std(apart[seen.rest])) if seen.rest.any() else math.inf
    if len(spans) > 1 and abs(constant) > max(APART_DEG, 2 * varies):
        return Finding(
            Cause.OFFSET,
            f"{name.capitalize()} is {constant:+.2f}° off at rest, always: calibrate both robots at home.",
            (name,),
            constant,
        )
    return None


def scaled(mine: Floats, around: Floats) -> tuple[float, float]:
    """Return the error of scale of an arm, and the sum of squares that it leaves."""
    way = mine - mine.mean()
    power = float(way @ way)
    slope = float(way @ around) / power if power else 0.0
    return slope, float(np.sum((around - slope * way) ** 2))


def stepped(seen: ComparedSamples, apart: Floats) -> tuple[float, float, float]:
    """Return the height (deg) and the time (s) of the step that explains the differences best, and what it leaves."""
    n, sums = len(apart), np.cumsum(apart)
    before = np.arange(1, n)
    means = sums[:-1] / before, (sums[-1] - sums[:-1]) / (n - before)
    left = float(np.sum(apart**2)) - before * means[0] ** 2 - (n - before) * means[1] ** 2
    best = int(np.argmin(left))
    return float(means[1][best] - means[0][best]), float(seen.t[best + 1]), float(left[best])


def scale(arms: tuple[str, ...], value: float) -> Finding:
    """Return the finding that arms move too far, or not far enough."""
    more = "more" if value > 0 else "less"
    verb = "moves" if len(arms) == 1 else "move"
    name = "All arms" if len(arms) == len(ARMS) else listed(arms).capitalize()
    return Finding(
        Cause.SCALE,
        f"{name} {verb} {abs(value):.1%} {more} on the hardware: check gears, microsteps and the robot file.",
        arms,
        value,
    )
