"""What a comparison shows about its cause: findings as data and as sentences, at most one for each effect."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Final

import numpy as np

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.arm_causes import (
    CLEAR_DEG,
    SCALE,
    STILL_DEG,
    Cause,
    ComparedSamples,
    Finding,
    causes_of,
    count,
    listed,
    rests,
    scale,
)
from beatrix_zenoh.recording.compare import Comparison

BEGAN_DEG: Final = 1.0
"""Robots that begin further apart began in different poses."""
UNLIKE: Final = 0.05
"""Arms are exchanged or reversed if the movement as it is leaves more than this share of the variance."""
BETTER: Final = 0.2
"""A cause explains the differences if it leaves less than this share of them."""
AFTER_S: Final = 1.0
"""The other robot must move later than this (s) after an arm stood still."""
MOTIONS: Final = 2
"""Number of motions during which an arm must stand still: a single one may be late."""
Mapped = tuple[tuple[int, ...], tuple[int, ...]]
"""For each arm of the first robot the index of an arm of the second, and its sign."""


def findings(found: Comparison) -> list[Finding]:
    """Return what the comparison shows, the most important first."""
    result = [*lost_samples(found), *new_homes(found), *following(found)]
    result += [*not_asked(found), *stopped(found)]
    seen = samples(found)
    if len(seen.t) < 2 or not found.anything_moved:
        return result
    if still := stood_still(found, seen) or stopped_moving(found, seen):
        return [*result, *still]
    began = began_apart(found, seen)
    if began is not None:
        result.append(began)
        seen = seen.where(seen.t > began.t)
        if len(seen.t) < 2:
            return result
    swapped = exchanged(seen)
    if swapped:
        return [*result, *swapped]
    return [*result, *arm_by_arm(seen)]


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


def stood_still(found: Comparison, seen: ComparedSamples) -> list[Finding]:
    """Return a finding if one robot was asked to move, and stood still while the other moved."""
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
        later = [part for part in found.moved if part.begin_s - found.t[0] > t and part.why]
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
    near = [all(abs(each[i]) < abs(first[i]) / 2 for i in gone) for each in means]
    together = [k for k in range(len(near)) if all(near[k:])]
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
    """Return the causes of the differences of each arm; a scale that all arms share is one finding."""
    result = [finding for i in range(len(ARMS)) for finding in causes_of(seen, i)]
    scales = [finding for finding in result if finding.cause is Cause.SCALE]
    if len(scales) == len(ARMS) and np.ptp([finding.value for finding in scales]) < SCALE:
        shared = scale(ARMS, float(np.mean([finding.value for finding in scales])))
        return [shared, *(finding for finding in result if finding not in scales)]
    return result


def lost_samples(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot of which samples are missing."""
    for name, regular in zip(("simulation", "hardware"), found.regularity, strict=True):
        if regular.lost:
            share = regular.lost / (regular.lost + regular.samples)
            yield Finding(
                Cause.LOSS,
                f"{regular.lost} samples of the {name} are missing ({share:.1%}): the network, or a busy computer, lost them.",
                value=share,
            )


def new_homes(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot that got another home during the recording."""
    for name, times in zip(("simulation", "hardware"), found.homes, strict=True):
        if times:
            yield Finding(
                Cause.NEW_HOME,
                f"The {name} got another home {count(times, 'time')} (CALIBRATE), and its angles count from the newest; the "
                f"figures are of the longest part between, {found.seconds:.1f} s.",
                value=times,
            )


def following(found: Comparison) -> Iterator[Finding]:
    """Yield a finding if the simulation made motions by following the hardware."""
    if found.followed:
        yield Finding(
            Cause.FOLLOWED,
            f"The simulation was not asked for {count(len(found.followed), 'motion')}, and made what the hardware made: it "
            "follows the hardware, so that the lag is its own, with the opposite sign.",
            value=len(found.followed),
            t=found.followed[0].request.t - float(found.t[0]),
        )


def not_asked(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each reason for which only one robot made a motion."""
    groups: dict[tuple[bool, str], list[float]] = {}
    for each in found.alone:
        groups.setdefault((each.hardware, each.why), []).append(each.request.t - float(found.t[0]))
    for (hardware, why), times in groups.items():
        one = "hardware" if hardware else "simulation"
        made = f"Only the {one} made {count(len(times), 'motion')}"
        when = ", ".join(f"{t:.1f} s" for t in times[:4]) + (", ..." if len(times) > 4 else "")
        yield Finding(
            Cause.NOT_ASKED,
            f"{made} (at {when}), because {why}; the figures leave out the time until both stand together again.",
            value=len(times),
            t=times[0],
        )


def stopped(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for the motions that only one robot carried out to the end."""
    for one, ends in (
        ("hardware", [motion for motion in found.early if motion.sim.end is Reason.OK]),
        ("simulation", [motion for motion in found.early if motion.sim.end is not Reason.OK]),
    ):
        if ends:
            ended = ends[0].hw if one == "hardware" else ends[0].sim
            yield Finding(
                Cause.STOPPED,
                f"Only the {one} ended {count(len(ends), 'motion')} before the goal ({ended.end}, at "
                f"{ends[0].sim.t - found.t[0]:.1f} s); the figures leave out the time until both stand together again.",
                value=len(ends),
                t=ends[0].sim.t - float(found.t[0]),
            )
