"""The known errors of tools/known_errors.py, and what a comparison has to find."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from known_robots import GOALS, Act, Arms, Known, acts

from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.diagnosis import FULL_STEP_DEG
from beatrix_zenoh.recording.finding import Cause
from beatrix_zenoh.recording.series import Floats

UNKNOWN = math.nan

Expected = tuple[Cause, tuple[str, ...], float]
"""Cause, arms and value of a finding; NaN: no value."""


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


HOME: Arms = (0.0, 0.0, 0.0)
JITTER_S = (0.01, 0.04, 0.025, 0.065, 0.045, 0.085, 0.07, 0.1)
LEADS = (0.0, 0.5, 1.5, 0.0, 1.5, 0.5, 0.0)


def with_leads(*leads_s: float) -> tuple[Act, ...]:
    """Return motions with leads (s)."""
    return tuple(
        replace(act, lead_s=lead_s) for act, lead_s in zip(acts(period_s=2.8), leads_s, strict=False)
    )


def with_jitter() -> tuple[Act, ...]:
    """Return the usual motions, each late by chance at the hardware, by more and more as it happens."""
    return tuple(replace(act, late_s=late_s) for act, late_s in zip(acts(), JITTER_S, strict=True))


def instead(index: int, *others: Act) -> tuple[Act, ...]:
    """Return the usual motions, one of them exchanged for others."""
    usual = acts()
    return (*usual[:index], *others, *usual[index + 1 :])


def of_time() -> list[Case]:
    """Return errors of clocks and delays."""
    return [
        Case("none", hw()),
        Case("delay of 50 ms", hw(late_s=0.05), 0.05),
        Case("delay of 200 ms", hw(late_s=0.2), 0.2),
        Case("stamps 200 ms late", hw(stamps_late_s=0.2), 0.2),
        Case("hardware 100 ms ahead", hw(late_s=-0.1), -0.1),
        Case("clocks 3 s apart", hw(late_s=3.0), 3.0, ((Cause.CLOCK, (), 3.0),)),
        Case("clock 1 % fast", hw(drift=0.01), 0.09, ((Cause.DRIFT, (), 0.01),)),
        Case("each motion late by chance", hw(), 0.055, requested=with_jitter(), alike=True),
        Case("stamps 0.9 s later than the requests say", hw(stamps_late_s=0.9), UNKNOWN, alike=False),
    ]


def of_arms() -> list[Case]:
    """Return errors of the angles of arms."""
    return [
        Case("short 0.5° off", added(0.5, 0, 0), 0.0, ((Cause.OFFSET, ("short",), 0.5),), alike=False),
        Case("long moves 5 % more", times(1, 1, 1.05), 0.0, ((Cause.SCALE, ("long",), 0.05),), alike=False),
        Case("all move 4 % less", times(0.96, 0.96, 0.96), 0.0, ((Cause.SCALE, ARMS, -0.04),), alike=False),
        Case(
            "all move twice as far, 50 ms late",
            replace(times(2, 2, 2), late_s=0.05),
            0.05,
            ((Cause.SCALE, ARMS, 1.0),),
            alike=False,
            all_known=True,
        ),
        Case(
            "long moves half as far",
            times(1, 1, 0.5),
            0.0,
            ((Cause.SCALE, ("long",), -0.5),),
            alike=False,
            all_known=True,
        ),
        Case(
            "long misses a step at 13 s",
            added(0, 0, -FULL_STEP_DEG, since_s=13.0),
            0.0,
            ((Cause.MISSED_STEPS, ("long",), -1),),
            alike=False,
        ),
        Case(
            "middle misses 4 steps at 8 s",
            added(0, 4 * FULL_STEP_DEG, 0, since_s=8.0),
            0.0,
            ((Cause.MISSED_STEPS, ("middle",), 4),),
            alike=False,
        ),
    ]


def of_wiring() -> list[Case]:
    """Return robots that do not make the same movement."""
    return [
        Case(
            "short and middle exchanged",
            changed(lambda _t, arms: arms[:, [1, 0, 2]]),
            UNKNOWN,
            ((Cause.EXCHANGED, ("short", "middle"), UNKNOWN),),
            alike=False,
        ),
        Case(
            "short inverted", times(-1, 1, 1), UNKNOWN, ((Cause.REVERSED, ("short",), UNKNOWN),), alike=False
        ),
        Case("all inverted", times(-1, -1, -1), UNKNOWN, ((Cause.REVERSED, ARMS, UNKNOWN),), alike=False),
        Case("stood still", times(0, 0, 0), UNKNOWN, ((Cause.STOOD_STILL, (), UNKNOWN),), alike=False),
        Case(
            "long stood still",
            times(1, 1, 0),
            UNKNOWN,
            ((Cause.STOOD_STILL, ("long",), UNKNOWN),),
            alike=False,
        ),
        Case(
            "all stand still from 8 s on",
            stopped_from(8.0, (0, 1, 2)),
            0.0,
            ((Cause.STOOD_STILL, (), UNKNOWN),),
            alike=False,
        ),
        Case(
            "long stands still from 10 s on",
            stopped_from(10.0, (2,)),
            0.0,
            ((Cause.STOOD_STILL, ("long",), UNKNOWN),),
            alike=False,
        ),
        Case(
            "began 12.4° apart",
            hw(start=(0.0, 12.4, -12.0)),
            0.0,
            ((Cause.BEGAN_APART, ("middle", "long"), 12.4),),
            alike=False,
        ),
        Case(
            "two different movements",
            changed(lambda t, arms: arms * 0 + np.outer(20 * np.sin(t * 1.3), (1, -1, 1))),
            UNKNOWN,
            alike=False,
        ),
    ]


def of_leads() -> list[Case]:
    """Return motions with leads."""
    third = acts()[3]
    return [
        Case(
            "lead of 1.5 s, 20 ms late", hw(late_s=0.02), 0.02, requested=tuple(acts(1.5, 2.8)), lead_s=(1.5,)
        ),
        Case("leads of 0, 0.5 and 1.5 s", hw(), 0.0, requested=with_leads(*LEADS), lead_s=(0.5, 1.5)),
        Case(
            "lead changed from 2 to 0.5 s",
            hw(),
            0.0,
            requested=instead(3, replace(third, lead_s=2.0, on="sim"), Act(third.t + 0.3, third.goal, 0.5)),
            lead_s=(0.8,),
        ),
        Case(
            "lead of 1.5 s in one motion, no events",
            hw(),
            0.0,
            requested=with_leads(0, 0, 0, 1.5, 0, 0, 0),
            events=False,
        ),
    ]


def of_requests() -> list[Case]:
    """Return motions of which a robot did not receive all."""
    third = acts()[3]
    return [
        Case(
            "one motion of the simulation alone",
            hw(),
            requested=instead(3, replace(third, on="sim", lead_s=None)),
            found=((Cause.NOT_ASKED, (), 1),),
        ),
        Case(
            "the simulation returns from a motion of its own",
            hw(),
            requested=instead(
                7,
                replace(acts()[6], t=acts()[7].t, goal=(5.0, 5.0, 5.0), on="sim", lead_s=None),
                Act(19.0, GOALS[6]),
            ),
            found=((Cause.NOT_ASKED, (), 1),),
            all_known=True,
        ),
        Case(
            "one motion of the hardware alone",
            hw(),
            requested=instead(3, replace(third, on="hw", lead_s=None)),
            found=((Cause.NOT_ASKED, (), 1),),
        ),
        Case(
            "refused by the hardware",
            hw(),
            requested=instead(3, replace(third, refused="Motors are off.")),
            found=((Cause.NOT_ASKED, (), 1),),
        ),
    ]


def of_ends() -> list[Case]:
    """Return motions that ended before their goal."""
    third = acts()[3]
    return [
        Case(
            "aborted in its lead",
            hw(),
            requested=instead(3, replace(third, on="sim", lead_s=1.5), Act(third.t + 0.4, None, on="sim")),
            found=((Cause.NOT_ASKED, (), 1),),
        ),
        Case(
            "another motion replaces one in its lead",
            hw(),
            requested=instead(3, replace(third, on="sim", lead_s=1.5), Act(third.t + 0.4, (25.0, 5.0, 5.0))),
            found=((Cause.NOT_ASKED, (), 1),),
        ),
        Case("replaced on both", hw(), requested=instead(3, third, Act(third.t + 0.4, (25.0, 5.0, 5.0)))),
        Case(
            "stopped on the hardware",
            hw(),
            requested=instead(3, third, Act(third.t + 0.4, None, on="hw")),
            found=((Cause.STOPPED, (), 1),),
        ),
    ]


def cases() -> list[Case]:
    """Return all known errors."""
    return [*of_time(), *of_arms(), *of_wiring(), *of_leads(), *of_requests(), *of_ends()]
