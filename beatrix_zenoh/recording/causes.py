"""What a comparison names beside its figures: facts that the data show without doubt. It says nothing about the rest."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.series import GRID_S, Flags, Floats, runs

FULL_STEP_DEG: Final = 360 / ROBOT.drive.full_steps * ROBOT.drive.gear_pinion / ROBOT.drive.gear_ring
APART_DEG: Final = 0.25
"""A smaller difference at rest is not worth a sentence: noise, and motors that behave like springs."""
SAME_DEG: Final = 0.2
"""Differences in two rests that are closer than this are the same."""
WHOLE_DEG: Final = 0.08
"""A whole number of full steps is at most this far from the change that it explains."""
MOST_STEPS: Final = 20
"""A larger change at once is no loss of steps."""
OTHER_DEG: Final = 3.0
"""Rests whose angles differ by more than this are rests in different poses: a wrong scale would differ between them."""
STILL_DEG: Final = 1.0
"""A robot whose arms turn by less than this stands still."""
REST_S: Final = 0.2
"""Rests that are shorter than this (s) are not looked at."""


class Cause(StrEnum):
    """What a finding is about."""

    STOOD_STILL = "stood still"
    ALONE = "alone"
    OFFSET = "offset"
    MISSED_STEPS = "missed steps"
    LOSS = "loss"


@dataclass(frozen=True)
class Finding:
    """A cause, the arms that it concerns, its size and a sentence about it."""

    cause: Cause
    sentence: str
    arms: tuple[str, ...] = ()
    value: float = math.nan
    """deg of OFFSET, full steps of MISSED_STEPS at the end, share of LOSS, number of motions of ALONE"""
    t: float = math.nan
    """time since the begin of the comparison (s), if the cause has one"""


def findings(found: Comparison) -> list[Finding]:
    """Return what the comparison shows, the most important last."""
    seen = found.compared & np.isfinite(np.hstack([found.first, found.second_after])).all(axis=1)
    result = [*lost_samples(found), *alone(found)]
    if not seen.any():
        return result
    still = list(stood_still(found, seen))
    steps = [finding for arm in ARMS for finding in off_at_rest(found, arm)] if not still else []
    changed = [finding.t for finding in steps if finding.cause is Cause.MISSED_STEPS]
    if len(set(changed)) < len(changed):  # arms that change at once were moved, or have their plugs exchanged
        steps = [finding for finding in steps if finding.cause is not Cause.MISSED_STEPS]
    return [*result, *still, *steps]


def lost_samples(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot of which samples are missing."""
    for name, recorded in zip(("simulation", "hardware"), found.robots, strict=True):
        if recorded.lost:
            share = recorded.lost / (recorded.lost + len(recorded.t))
            yield Finding(
                Cause.LOSS,
                f"{recorded.lost} samples of the {name} are missing ({share:.1%}): the network, or a busy computer, lost them.",
                value=share,
            )


def alone(found: Comparison) -> Iterator[Finding]:
    """Yield a finding for each robot that made, or ended, motions alone."""
    for name, hardware in (("simulation", False), ("hardware", True)):
        times = [each.t - float(found.t[0]) for each in found.alone if each.hardware is hardware]
        if times:
            when = ", ".join(f"{t:.1f} s" for t in times[:4]) + (", ..." if len(times) > 4 else "")
            yield Finding(
                Cause.ALONE,
                f"Only the {name} made, or finished, {count(len(times), 'motion')} (at {when}); the figures leave out the time until "
                "both stand together again.",
                value=len(times),
                t=times[0],
            )


def stood_still(found: Comparison, seen: Flags) -> Iterator[Finding]:
    """Yield a finding if one robot was asked to move, and stood still while the other moved."""
    arms = [angles[seen, : len(ARMS)] for angles in (found.first, found.second_after)]
    ways = [np.ptp(each, axis=0).max() for each in arms]
    for name, i in (("hardware", 1), ("simulation", 0)):
        asked = any(not request.refused for request in found.robots[i].requests)
        if asked and ways[i] < STILL_DEG and ways[1 - i] > OTHER_DEG:
            yield Finding(Cause.STOOD_STILL, f"The {name} stood still: check its motors, power and STOP.")


@dataclass
class Level:
    """Rests, one after the other, in which an arm of the hardware is off by the same angle."""

    t: float
    """begin of the first rest (s)"""
    apart: Floats
    """hardware minus simulation (deg) in all of these rests"""
    poses: list[float]
    """angle of the arm (deg) in each rest"""

    @property
    def deg(self) -> float:
        """The angle by which the arm is off."""
        return float(np.median(self.apart))


def levels(found: Comparison, arm: int) -> list[Level]:
    """Return by how much an arm is off in the rests of both robots; nothing if it moves away during one of them."""
    mine, apart = found.first[:, arm], (found.second_after - found.first)[:, arm]
    result: list[Level] = []
    for begin, end in runs(found.rest):
        if (end - begin) * GRID_S < REST_S:
            continue
        half = (begin + end) // 2
        if abs(np.median(apart[begin:half]) - np.median(apart[half:end])) > SAME_DEG / 2:
            return []
        here = Level(
            float(found.t[begin] - found.t[0]), apart[begin:end], [float(np.median(mine[begin:end]))]
        )
        if result and abs(here.deg - result[-1].deg) < SAME_DEG:
            result[-1].apart = np.concatenate([result[-1].apart, here.apart])
            result[-1].poses += here.poses
        else:
            result.append(here)
    return result


def off_at_rest(found: Comparison, arm: str) -> Iterator[Finding]:
    """Yield findings if an arm is off at rest by a constant angle, or by whole full steps from a time on.

    The first angle must be the same in different poses; a scale, for example, depends on the pose.
    """
    all_levels = levels(found, ARMS.index(arm))
    if not all_levels or np.ptp(all_levels[0].poses) < OTHER_DEG:
        return
    first, *later = all_levels
    changes = np.diff([first.deg, *(level.deg for level in later)])
    steps = np.round(changes / FULL_STEP_DEG)
    if np.any(
        (np.abs(changes - steps * FULL_STEP_DEG) > WHOLE_DEG) | (steps == 0) | (np.abs(steps) > MOST_STEPS)
    ):
        return
    name = arm.capitalize()
    if abs(first.deg) > APART_DEG:
        sentence = f"{name} is {first.deg:+.2f}° off at rest{' at first' * bool(later)}: calibrate both robots at home."
        yield Finding(Cause.OFFSET, sentence, (arm,), first.deg)
    if later:
        off = " and ".join(f"{level.deg:+.2f}° off at rest from {level.t:.1f} s on" for level in later)
        total = int(steps.sum())
        yield Finding(
            Cause.MISSED_STEPS,
            f"{name} is {off}, {count(abs(total), 'full step')}{' in all' * (len(later) > 1)}: the simulation's arm missed steps, "
            "or the hardware's count of steps changed (it notices no missed step). Move both home and calibrate.",
            (arm,),
            float(total),
            later[0].t,
        )


def count(number: int, what: str) -> str:
    """Return a number with its noun."""
    return f"{number} {what}" + "s" * (number != 1)
