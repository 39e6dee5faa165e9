"""Known errors of the angles of arms, and what a comparison has to find."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from known_robots import Act, Known, acts

from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.causes import FULL_STEP_DEG, Cause
from beatrix_zenoh.recording.compare import Thresholds
from beatrix_zenoh.recording.series import Floats

UNKNOWN = math.nan

Expected = tuple[Cause, str, float]
"""Cause, arm and value of a finding; NaN: no value."""


@dataclass(frozen=True)
class Case:
    """A known error and what the comparison has to find."""

    name: str
    hw: Known
    lag_s: float = 0.0
    """NaN: it has to say that the lag is unknown"""
    found: tuple[Expected, ...] = ()
    requested: tuple[Act, ...] = field(default_factory=lambda: tuple(acts()))
    lead_s: tuple[float, ...] = ()
    """leads of the motions whose lag is known"""
    alike: bool = True
    """after removal of lead and lag, the movements are the same within RMS_DEG"""
    events: bool = True
    all_known: bool = False
    """the lag of no motion is unknown"""
    sim: Known = field(default_factory=lambda: Known("sim", seed=7))
    said: str = ""
    """a part of the sentences"""
    checks: tuple[tuple[Thresholds, bool], ...] = ()
    """thresholds, and whether the comparison is within them"""


hw = partial(Known, "hw")
"""Makes hardware with errors."""


def changed(change: Callable[[Floats, Floats], Floats]) -> Known:
    """Return hardware whose arms are not where they should be."""
    return hw(change=change)


def added(*arms: float, since_s: float = 0.0) -> Known:
    """Return hardware whose arms are off by an angle (deg), from a time (s) on."""
    return changed(lambda t, angles: angles + np.outer(t >= since_s, arms))


def times(*factors: float) -> Known:
    """Return hardware whose arms move by a multiple."""
    return changed(lambda _t, angles: angles * np.array(factors))


def stopped_from(since_s: float, arms: Sequence[int]) -> Known:
    """Return hardware whose arms stand still from a time (s) on."""

    def change(t: Floats, angles: Floats) -> Floats:
        """Return the angles with those of the arms held."""
        held = angles.copy()
        held[np.ix_(t >= since_s, np.array(arms))] = angles[np.searchsorted(t, since_s), np.array(arms)]
        return held

    return changed(change)


def of_arms() -> list[Case]:
    """Return errors of the angles of arms."""
    return [
        Case("short 0.5° off", added(0.5, 0, 0), 0.0, ((Cause.OFFSET, "short", 0.5),), alike=False),
        Case("long moves 5 % more", times(1, 1, 1.05), alike=False),
        Case("all move 4 % less", times(0.96, 0.96, 0.96), alike=False),
        Case(
            "all move twice as far, 50 ms late",
            replace(times(2, 2, 2), late_s=0.05),
            0.05,
            alike=False,
            all_known=True,
        ),
        Case("long moves half as far", times(1, 1, 0.5), alike=False, all_known=True),
        Case(
            "long misses a step at 13 s",
            added(0, 0, -FULL_STEP_DEG, since_s=13.0),
            0.0,
            ((Cause.MISSED_STEPS, "long", -1),),
            alike=False,
        ),
        Case(
            "middle misses 4 steps at 8 s",
            added(0, 4 * FULL_STEP_DEG, 0, since_s=8.0),
            0.0,
            ((Cause.MISSED_STEPS, "middle", 4),),
            alike=False,
        ),
    ]


def moved_away(*rates: float) -> Known:
    """Return hardware whose arms move away by an angle (deg) in each second."""
    return changed(lambda t, angles: angles + np.outer(t, rates))


def lost(arm: int, *losses: tuple[float, float], offset: float = 0.0) -> Known:
    """Return hardware of which an arm is off by `offset` (deg), and loses full steps at times (s)."""

    def change(t: Floats, angles: Floats) -> Floats:
        """Return the angles without the lost steps."""
        off = offset + sum(FULL_STEP_DEG * steps * (t >= at_s) for at_s, steps in losses)
        return angles + np.outer(off, np.arange(len(ARMS)) == arm)

    return changed(change)


def case(name: str, robot: Known, *found: Expected, sim: Known | None = None, said: str = "") -> Case:
    """Return a case in which the robots differ and the lag is 0."""
    return Case(name, robot, 0.0, found, alike=False, sim=sim or Known("sim"), said=said)


def of_losses() -> list[Case]:
    """Return arms that lose steps more than once, or beside another error."""
    missed, offset = Cause.MISSED_STEPS, Cause.OFFSET
    slipped = Known("sim", slip=lambda t, angles: angles - np.outer(t >= 8.5, (0, 0, 4 * FULL_STEP_DEG)))
    return [
        case(
            "long misses 2 steps at 8 s and 3 at 17 s",
            lost(2, (8.0, -2), (17.0, -3)),
            (missed, "long", -5),
            said="Long is -1.38° off at rest from 8.",
        ),
        case(
            "long misses a step at 5 s, one at 10 s and two at 16 s",
            lost(2, (5.0, -1), (10.0, -1), (16.0, -2)),
            (missed, "long", -4),
        ),
        case("short loses 3 steps and regains 2", lost(0, (7.0, 3), (15.0, -2)), (missed, "short", 1)),
        case(
            "short 0.5° off misses a step at 12 s",
            lost(0, (12.0, -1), offset=0.5),
            (offset, "short", 0.5),
            (missed, "short", -1),
            said="Short is -0.19° off at rest from 1",
        ),
        case(
            "middle misses 2 steps at 9 s, long 1° off",
            changed(lambda t, angles: angles + np.outer(t >= 9, (0, -2 * FULL_STEP_DEG, 0)) + (0, 0, 1)),
            (missed, "middle", -2),
            (offset, "long", 1.0),
        ),
        case(
            "the simulation slips 4 steps at 8.5 s",
            hw(),
            (missed, "long", 4),
            sim=slipped,
            said="the simulation's arm missed steps",
        ),
        case(
            "long misses a step, and the simulation does not",
            lost(2, (13.0, -1)),
            (missed, "long", -1),
            said="the hardware's count of steps changed",
        ),
    ]


def of_other_changes() -> list[Case]:
    """Return changes of arms that are no lost steps."""
    return [
        case("middle moves away by 1° in 24.5 s", moved_away(0, 1 / 24.5, 0)),
        case("all arms move away by 1.5° in 24.5 s", moved_away(*[-1.5 / 24.5] * 3)),
        case("long slips by 0.6°, no full step", added(0, 0, -0.6, since_s=12.5)),
        case("middle is pushed by 1°", added(0, 1.0, 0, since_s=12.5)),
        case(
            "middle moves 3 % more and is 0.8° off",
            changed(lambda _t, angles: angles * (1, 1.03, 1) + (0, 0.8, 0)),
        ),
    ]


def late_arm(arm: int, late_s: float) -> Known:
    """Return hardware of which one arm moves later than the others (s)."""

    def change(t: Floats, angles: Floats) -> Floats:
        """Return the angles with those of the arm delayed."""
        moved = angles.copy()
        moved[:, arm] = np.interp(t - late_s, t, angles[:, arm])
        return moved

    return changed(change)


def of_one_arm() -> list[Case]:
    """Return arms that are late alone."""
    two = [replace(act, goal=(act.goal[0], 0.0, act.goal[2] - 10.0)) for act in acts() if act.goal]
    late = (
        ("long 200 ms late", late_arm(2, 0.2), acts()),
        ("middle 100 ms late", late_arm(1, 0.1), acts()),
        ("long 60 ms late", late_arm(2, 0.06), acts()),
        ("short 80 ms ahead", late_arm(0, -0.08), acts()),
        ("one of two arms 100 ms late", late_arm(2, 0.1), two),
    )
    return [
        Case(name, robot, UNKNOWN, requested=tuple(requested), alike=False, said="have different lags")
        for name, robot, requested in late
    ]


def of_wiring() -> list[Case]:
    """Return robots that do not make the same movement."""
    return [
        Case("short and middle exchanged", changed(lambda _t, arms: arms[:, [1, 0, 2]]), alike=False),
        Case("short inverted", times(-1, 1, 1), UNKNOWN, alike=False),
        Case("all inverted", times(-1, -1, -1), UNKNOWN, alike=False),
    ]


def of_standing() -> list[Case]:
    """Return robots of which one, or an arm, stands still, and robots that begin or move differently."""
    return [
        Case("stood still", times(0, 0, 0), UNKNOWN, ((Cause.STOOD_STILL, "", UNKNOWN),), alike=False),
        Case(
            "the simulation stood still",
            hw(),
            UNKNOWN,
            ((Cause.STOOD_STILL, "", UNKNOWN),),
            alike=False,
            sim=Known("sim", change=lambda _t, arms: 0.0 * arms),
            said="The simulation stood still",
        ),
        Case("long stood still", times(1, 1, 0), UNKNOWN, alike=False),
        Case(
            "all stand still from 8 s on",
            stopped_from(8.0, (0, 1, 2)),
            alike=False,
            checks=((Thresholds(lag_s=9.0), False),),  # the lag of most motions is unknown
        ),
        Case("long stands still from 10 s on", stopped_from(10.0, (2,)), alike=False),
        Case("began 12.4° apart", hw(start=(0.0, 12.4, -12.0)), alike=False),
        Case(
            "two different movements",
            changed(lambda t, arms: arms * 0 + np.outer(20 * np.sin(t * 1.3), (1, -1, 1))),
            UNKNOWN,
            alike=False,
        ),
    ]


def of_all_arms() -> list[Case]:
    """Return all known errors of arms."""
    return [*of_arms(), *of_losses(), *of_other_changes(), *of_one_arm(), *of_wiring(), *of_standing()]
