"""A comparison of simulation and hardware as text and as JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import msgspec

from beatrix_zenoh.output import columns
from beatrix_zenoh.recording.causes import count, findings
from beatrix_zenoh.recording.compare import MOST, AxisDifference, Comparison, why_no_lag
from beatrix_zenoh.recording.series import HOLE_S, regularity

AXIS_HEADS = (
    "hw - sim",
    "lag ms",
    "largest°",
    "rms°",
    "largest° after",
    "rms° after",
    "at rest°",
    "offset°",
)
SAMPLE_HEADS = (
    "robot",
    "samples",
    "lost",
    "period ms",
    "jitter ms",
    "gaps",
    "longest ms",
    "off set point°",
    "missed",
)
AFTER = '"after": each motion of the hardware is shifted by its lead and its lag; head: the angle between both heads.'
ZERO_S = 0.00005
"""A lag closer to 0 than this (s) is shown as 0.0 ms."""
UNCERTAIN_S = 0.001
"""Smallest uncertainty of the clock offset (s) that the text states."""


def text(found: Comparison, exceeded: Sequence[str]) -> str:
    """Return tables, sentences about leads, lags, causes, gaps and clocks, and one for each threshold exceeded."""
    return "\n".join([
        axes_table(found.axes),
        AFTER,
        "",
        columns(SAMPLE_HEADS, [sample_row(found, 0), sample_row(found, 1)]),
        "",
        compared_sentence(found),
        *lead_sentences(found),
        lag_sentence(found),
        *(finding.sentence for finding in findings(found)),
        *clock_sentences(found),
        *exceeded,
    ])  # fmt: skip


def axes_table(axes: Sequence[AxisDifference]) -> str:
    """Return a table with a row for each axis: the lag in ms, the differences in deg."""
    rows = [
        (
            axis.axis,
            number(axis.lag_s * 1e3, 1),
            *(number(value, 2) for value in (axis.largest, axis.rms, axis.largest_after, axis.rms_after)),
            *(number(value, 2) for value in (axis.at_rest, axis.offset)),
        )
        for axis in axes
    ]
    return columns(AXIS_HEADS, rows)


def number(value: float, digits: int) -> str:
    """Format a number with this many decimals; NaN, which means not measured, as a dash."""
    return "-" if math.isnan(value) else f"{value:z.{digits}f}"


def sample_row(found: Comparison, index: int) -> tuple[str, ...]:
    """Return the row of one robot in the table of samples."""
    recorded = found.robots[index]
    regular = regularity(recorded)
    return (
        "{} ({})".format(*recorded.place),
        str(regular.samples),
        "-" if regular.lost is None else str(regular.lost),
        f"{regular.period_ms:.1f}",
        f"{regular.jitter_ms:.2f}",
        str(regular.gaps),
        f"{regular.longest_ms:.1f}",
        number(found.off_set_points[index], 2),
        "-" if recorded.slipped is None else str(recorded.slipped),
    )


def lead_sentences(found: Comparison) -> list[str]:
    """Return a sentence for each lead that was requested: how much later the hardware began."""
    leads: dict[float, list[float]] = {}
    for part in found.moved:
        if part.lead_s:
            leads.setdefault(round(part.lead_s, 3), []).append(part.shift_s if part.measured else math.nan)
    sentences = []
    for lead_s, shifts_s in sorted(leads.items()):
        known = sorted(shift_s for shift_s in shifts_s if not math.isnan(shift_s))
        measured = f"began {span(known, 3)} s after" if known else "began at an unknown time after"
        sentences.append(
            f"Lead of {lead_s:g} s, {count(len(shifts_s), 'motion')}: the hardware {measured} the simulation."
        )
    return sentences


def lag_sentence(found: Comparison) -> str:
    """Return a sentence with the lag of the hardware (ms) in the recording and in its motions, or why there is none."""
    if math.isnan(found.lag_s):
        return f"No lag can be measured: {why_no_lag(found)}"
    behind = "behind" if found.lag_s > -ZERO_S else "ahead of"
    beyond = ", beyond the lead" if any(part.lead_s for part in found.moved) else ""
    sentence = (
        f"The hardware's set points are {abs(found.lag_s) * 1e3:.1f} ms {behind} the simulation's{beyond}."
    )
    lags_ms = sorted(part.lag_s * 1e3 for part in found.moved if not math.isnan(part.lag_s))
    if lags_ms:
        sentence += f" In {count(len(lags_ms), 'motion')} the positions lag by {span(lags_ms, 1)} ms."
    if unknown := [part.why for part in found.moved if math.isnan(part.lag_s)]:
        reasons = "; ".join(list(dict.fromkeys(unknown))[:MOST])
        sentence += f" In {count(len(unknown), 'motion')} the lag is unknown: {reasons}."
    return sentence


def span(ordered: Sequence[float], digits: int) -> str:
    """Format the smallest and the largest of ascending numbers, or the one if they look equal."""
    low, high = (f"{value:z.{digits}f}" for value in (ordered[0], ordered[-1]))
    return low if low == high else f"{low} to {high}"


def compared_sentence(found: Comparison) -> str:
    """Return a sentence with the compared part of the shared time."""
    sentence = f"{found.compared_s:.1f} s of {found.shared_s:.1f} s were compared"
    if found.shared_s - found.seconds >= HOLE_S:
        sentence += f", in the longest part ({found.seconds:.1f} s) without a gap of more than {HOLE_S:g} s, or another home (CALIBRATE)"
    return f"{sentence}."


def clock_sentences(found: Comparison) -> list[str]:
    """Return a sentence with the uncertainty of the clock offset; no sentence if it is below UNCERTAIN_S."""
    bound_s = sum(recorded.clock_s for recorded in found.robots)
    if bound_s < UNCERTAIN_S:
        return []
    return [
        f"The offset of the two clocks is known to ±{bound_s * 1e3:.1f} ms, so the lag has the same uncertainty."
    ]


def as_document(found: Comparison, exceeded: Sequence[str]) -> Mapping[str, object]:
    """Return a comparison for JSON output; keys of quantities end with the unit.

    Axes are in deg, but their lags in s. NaN, which is null in JSON, means not measured.
    """
    return {
        "result": not exceeded,
        "message": lag_sentence(found),
        "exceeded": list(exceeded),
        "robot": found.robots[0].place[0],
        "moved": found.anything_moved,
        "lag_s": found.lag_s,
        "compared_s": found.compared_s,
        "shared_s": found.shared_s,
        "clocks_known_to_s": sum(recorded.clock_s for recorded in found.robots),
        "motions": msgspec.to_builtins(found.moved),
        "leads": lead_sentences(found),
        "findings": [
            {**msgspec.to_builtins(finding), "cause": finding.cause.value} for finding in findings(found)
        ],
        "axes_deg": msgspec.to_builtins(found.axes),
        "robots": [
            {
                "side": recorded.place[1],
                **msgspec.to_builtins(regularity(recorded)),
                "off_set_points_deg": off_deg,
                "missed_steps": recorded.slipped,
            }
            for recorded, off_deg in zip(found.robots, found.off_set_points, strict=True)
        ],
    }
