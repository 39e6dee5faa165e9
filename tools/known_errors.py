"""Compare robots with known errors; print truth, figure and sentence of each, and fail if one is not found.

Each row is compared as it is, with noise, with lost samples, and from a recording's file.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from known_robots import GOALS, Act, Arms, Known, acts, as_recordings, from_file

from beatrix_zenoh.cli.comparison_text import lag_sentence, lead_sentences
from beatrix_zenoh.cli.output import columns
from beatrix_zenoh.recording.compare import Comparison, compare
from beatrix_zenoh.recording.diagnosis import FULL_STEP_DEG, findings
from beatrix_zenoh.recording.finding import Cause, Finding
from beatrix_zenoh.recording.series import Floats

SECONDS = 21.0
LAG_S, LEAD_S, RMS_DEG = 0.005, 0.02, 0.15
NOISE_DEG, LOST = 0.1, 0.1
TOLERANCE = {
    Cause.OFFSET: 0.05,
    Cause.SCALE: 0.005,
    Cause.DRIFT: 0.001,
    Cause.CLOCK: 0.01,
    Cause.BEGAN_APART: 0.3,
    Cause.LOSS: 0.03,
}
"""How much the figure of a finding may differ from the truth; 0 of all others."""
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


@dataclass(frozen=True)
class Variant:
    """Disturbances that are added to a case."""

    name: str
    noise_deg: float = 0.0
    lost: float = 0.0
    file: bool = False


VARIANTS = (
    Variant("exact"),
    Variant("noise", noise_deg=NOISE_DEG),
    Variant("10 % lost", lost=LOST),
    Variant("file, noise, 10 % lost", noise_deg=NOISE_DEG, lost=LOST, file=True),
)


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


ALL = ("short", "middle", "long")
HOME: Arms = (0.0, 0.0, 0.0)
LEADS = (0.0, 0.5, 1.5, 0.0, 1.5, 0.5, 0.0)


def with_leads(*leads_s: float) -> tuple[Act, ...]:
    """Return motions with leads (s)."""
    return tuple(
        replace(act, lead_s=lead_s) for act, lead_s in zip(acts(period_s=2.8), leads_s, strict=False)
    )


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
        Case("stamps 0.9 s later than the requests say", hw(stamps_late_s=0.9), UNKNOWN, alike=False),
    ]


def of_arms() -> list[Case]:
    """Return errors of the angles of arms."""
    return [
        Case("short 0.5° off", added(0.5, 0, 0), 0.0, ((Cause.OFFSET, ("short",), 0.5),), alike=False),
        Case("long moves 5 % more", times(1, 1, 1.05), 0.0, ((Cause.SCALE, ("long",), 0.05),), alike=False),
        Case("all move 4 % less", times(0.96, 0.96, 0.96), 0.0, ((Cause.SCALE, ALL, -0.04),), alike=False),
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
        Case("all inverted", times(-1, -1, -1), UNKNOWN, ((Cause.REVERSED, ALL, UNKNOWN),), alike=False),
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


def compared(case: Case, variant: Variant, folder: Path) -> Comparison:
    """Carry a case out and compare both robots."""
    sim = Known("sim", noise_deg=variant.noise_deg, seed=7)
    hardware = replace(case.hw, noise_deg=variant.noise_deg, lost=variant.lost, events=[])
    seconds = SECONDS + 3.5
    if variant.file:
        path = folder / "known.rrd"
        return compare(*from_file(path, (sim, hardware), case.requested, seconds, events=case.events))
    return compare(*as_recordings((sim, hardware), case.requested, seconds, events=case.events))


def wrong(case: Case, variant: Variant, found: Comparison) -> list[str]:
    """Return what the comparison did not find, or found although it is not there."""
    result = []
    noise = 1.0 if not variant.noise_deg else 1.5
    if math.isnan(case.lag_s) != math.isnan(found.lag_s) or abs(found.lag_s - case.lag_s) > LAG_S * (
        4 if case.hw.drift else 1
    ):
        result.append(f"lag {found.lag_s:.3f} s instead of {case.lag_s:.3f} s")
    shifts = [part.shift_s for part in found.moved if part.measured]
    result += [
        f"no motion with a lead of {lead_s:g} s"
        for lead_s in case.lead_s
        if not any(abs(shift_s - lead_s - case.lag_s) < LEAD_S for shift_s in shifts)
    ]
    if case.all_known:
        result += [part.why for part in found.moved if part.why]
    rms = max(axis.rms_after for axis in found.axes)
    if case.alike and not rms < RMS_DEG * noise + 1.7 * variant.noise_deg:
        result.append(f"rms after removal {rms:.3f}°")
    expected = list(case.found) + [(Cause.LOSS, (), LOST)] * bool(variant.lost)
    got = findings(found)
    for cause, arms, value in expected:
        if not any(fits(finding, cause, arms, value) for finding in got):
            result.append(f"not found: {cause} {' '.join(arms)} {value:g}")
    surplus = [each.sentence for each in got if not any(fits(each, *one) for one in expected)]
    return [*result, *surplus]


def fits(finding: Finding, cause: Cause, arms: tuple[str, ...], value: float) -> bool:
    """Return whether a finding is the expected one."""
    near = math.isnan(value) or abs(finding.value - value) <= TOLERANCE.get(cause, 0.0)
    return (finding.cause, finding.arms) == (cause, arms) and near


def row(case: Case, found: Comparison, faults: Sequence[str]) -> tuple[str, ...]:
    """Return the row of one case: truth, figures and sentences."""
    lag = "unknown" if math.isnan(found.lag_s) else f"{found.lag_s * 1e3:z.1f} ms"
    truth = "unknown" if math.isnan(case.lag_s) else f"{case.lag_s * 1e3:z.1f} ms"
    said = [finding.sentence for finding in findings(found) if finding.cause is not Cause.LOSS]
    sentences = said or lead_sentences(found) or [lag_sentence(found)]
    rms = max(axis.rms_after for axis in found.axes)
    return (case.name, truth, lag, f"{rms:.2f}", "WRONG" if faults else "ok", sentences[-1])


def main() -> int:
    """Print a table for each variant; return 1 if a row is wrong."""
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        for variant in VARIANTS:
            rows, all_faults = [], []
            for case in cases():
                found = compared(case, variant, Path(folder))
                faults = wrong(case, variant, found)
                rows.append(row(case, found, faults))
                all_faults += [f"WRONG: {case.name}: {fault}" for fault in faults]
            print(f"{variant.name}: {len(rows)} known errors")
            print(columns(("error", "lag", "measured", "rms° after", "", "sentence"), rows))
            print("\n".join(all_faults))
            bad += len(all_faults)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
