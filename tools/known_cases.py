"""The known errors of tools/known_errors.py, and what a comparison has to find."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from known_arm_cases import UNKNOWN, Case, hw, of_all_arms
from known_robots import GOALS, Act, Arms, Known, acts

from beatrix_zenoh.recording.causes import Cause
from beatrix_zenoh.recording.compare import Thresholds

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
        Case("clocks 3 s apart", hw(late_s=3.0), 3.0),
        Case("clock 1 % fast", hw(drift=0.01), 0.09),
        Case("each motion late by chance", hw(), 0.055, requested=with_jitter(), alike=True),
        Case("stamps 0.9 s later than the requests say", hw(stamps_late_s=0.9), 0.9, all_known=True),
        Case("stamps 1.4 s later than the requests say", hw(stamps_late_s=1.4), UNKNOWN, alike=False),
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
            found=((Cause.ALONE, "", 1),),
        ),
        Case(
            "the simulation returns from a motion of its own",
            hw(),
            requested=instead(
                7,
                replace(acts()[6], t=acts()[7].t, goal=(5.0, 5.0, 5.0), on="sim", lead_s=None),
                Act(19.0, GOALS[6]),
            ),
            found=((Cause.ALONE, "", 1),),
            all_known=True,
        ),
        Case(
            "one motion of the hardware alone",
            hw(),
            requested=instead(3, replace(third, on="hw", lead_s=None)),
            found=((Cause.ALONE, "", 1),),
        ),
        Case(
            "refused by the hardware",
            hw(),
            requested=instead(3, replace(third, refused="Motors are off.")),
            found=((Cause.ALONE, "", 1),),
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
            found=((Cause.ALONE, "", 1),),
        ),
        Case(
            "another motion replaces one in its lead",
            hw(),
            requested=instead(3, replace(third, on="sim", lead_s=1.5), Act(third.t + 0.4, (25.0, 5.0, 5.0))),
            found=((Cause.ALONE, "", 1),),
        ),
        Case("replaced on both", hw(), requested=instead(3, third, Act(third.t + 0.4, (25.0, 5.0, 5.0)))),
        Case(
            "stopped on the hardware",
            hw(),
            requested=instead(3, third, Act(third.t + 0.4, None, on="hw")),
            found=((Cause.ALONE, "", 1),),
        ),
    ]


def of_one_robot() -> list[Case]:
    """Return motions of one robot alone, after which both go to the same place on ways of different length."""
    far: Arms = (30.0, 30.0, 30.0)
    near: Arms = (5.0, 5.0, 5.0)
    usual = acts()[3:]

    def then(
        name: str, *others: Act, robot: Known | None = None, lag_s: float = 0.0, motions: float = 1
    ) -> Case:
        """Return a case in which both turn far, one makes other motions, and both go home."""
        return Case(
            name,
            robot or hw(),
            lag_s,
            ((Cause.ALONE, "", motions),),
            (Act(1.0, far), *others, Act(5.4, HOME), *usual),
            checks=((Thresholds(rms_deg=0.5, largest_deg=1.0), True),),
        )

    alone = Act(3.2, near, None, "sim")
    return [
        then("the simulation alone, then both home", alone),
        then("the simulation alone, then both home, 100 ms late", alone, robot=hw(late_s=0.1), lag_s=0.1),
        then("the hardware alone, then both home", replace(alone, on="hw")),
        then("the simulation alone twice, then both home", alone, Act(4.3, far, None, "sim"), motions=2),
        then("the simulation alone until both are sent home", replace(alone, t=5.2)),
        then("the simulation alone, to almost the same place", replace(alone, goal=(28.0, 28.0, 28.0))),
    ]


def of_rates() -> list[Case]:
    """Return few positions in a second."""
    unknown = tuple(
        (limits, False)
        for limits in (Thresholds(lag_s=9.0), Thresholds(rms_deg=99.0), Thresholds(rest_deg=99.0))
    )
    few = [
        Case(
            f"{hz} positions in a second",
            hw(period_s=1 / hz),
            UNKNOWN,
            alike=False,
            checks=unknown,
            said="most of it lies in gaps",
        )
        for hz in (8, 5, 3, 2)
    ]
    return [
        *few,
        Case("10 positions in a second, 100 ms late", hw(period_s=0.1, late_s=0.1), 0.1, alike=False),
        Case("100 positions in a second", hw(period_s=0.01), all_known=True),
    ]


def of_clocks() -> list[Case]:
    """Return clocks that jump, and leads that ended early."""
    fails = ((Thresholds(lag_s=9.0), False),)
    later = [replace(act, late_s=0.3 if act.t > 9 else 0.0) for act in acts()]

    def jump(name: str, robot: Known, requested: Sequence[Act] = ()) -> Case:
        """Return a case with lags that differ."""
        return Case(
            name,
            robot,
            UNKNOWN,
            requested=tuple(requested or acts()),
            alike=False,
            said="the lags of the motions differ",
            checks=fails,
        )

    return [
        jump("clock jumps by 0.5 s", hw(jump=(12.7, 0.5))),
        jump("clock jumps back by 0.5 s", hw(jump=(12.7, -0.5))),
        jump("clock jumps by 0.4 s at 6 s", hw(jump=(6.1, 0.4))),
        jump("requests are 300 ms late from 9 s on", hw(), later),
        Case(
            "hardware begins 0.9 s after the simulation, lead of 2 s",
            hw(),
            UNKNOWN,
            requested=tuple(replace(act, late_s=-1.1) for act in acts(2.0, 3.5)[:6]),
            said="Lead of 2 s, 6 motions: the hardware began 0.9",
            checks=fails,
        ),
        Case("hardware 0.8 s ahead", hw(late_s=-0.8), -0.8, all_known=True),
        Case(
            "equal motions each second, 1.9 s late",
            hw(late_s=1.9),
            1.9,
            requested=tuple(
                Act(1.0 + i, (15.0, 15.0, 15.0) if i % 2 else (-15.0, -15.0, -15.0)) for i in range(20)
            ),
            all_known=True,
        ),
    ]


def of_speed() -> list[Case]:
    """Return hardware that moves more slowly, or faster, and noise on both robots."""

    def case(name: str, robot: Known, speed: float = 60.0) -> Case:
        """Return a case of hardware that begins in time, and of a simulation with a speed (deg/s)."""
        return Case(
            name,
            robot,
            UNKNOWN,
            alike=False,
            sim=Known("sim", seed=7, speed=speed),
            said="have different lags",
            checks=((Thresholds(lag_s=9.0), False),),
        )

    return [
        case("half speed", hw(speed=30.0)),
        case("20 % slower", hw(speed=48.0)),
        case("40 % faster", hw(speed=42.0), 30.0),
        case("acceleration of 50 instead of 180°/s²", hw(acceleration=50.0)),
        *(
            Case(
                f"noise of {noise}° on both",
                hw(noise_deg=noise),
                alike=False,
                sim=Known("sim", noise_deg=noise, seed=7),
                all_known=True,
                checks=((Thresholds(largest_deg=8 * noise), True),),
            )
            for noise in (0.15, 0.3)
        ),
        Case("noise of 0.3° on the hardware", hw(noise_deg=0.3), alike=False, all_known=True),
    ]


def cases() -> list[Case]:
    """Return all known errors."""
    return [
        *of_time(),
        *of_all_arms(),
        *of_leads(),
        *of_requests(),
        *of_one_robot(),
        *of_ends(),
        *of_rates(),
        *of_clocks(),
        *of_speed(),
    ]
