"""A comparison of simulation and hardware as text and as JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import msgspec

from beatrix_zenoh.cli.output import columns
from beatrix_zenoh.recording.compare import AxisDifference, Comparison
from beatrix_zenoh.recording.record_robots import LiveRecording
from beatrix_zenoh.recording.series import HOLE_S
from beatrix_zenoh.recording.thresholds import why_no_lag

AXIS_HEADS = (
    "hardware - simulation",
    "lag ms",
    "largest°",
    "rms°",
    "largest° after",
    "rms° after",
    "at rest°",
    "mean at rest°",
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
AFTER = '"after": each motion of the hardware is shifted by its own lag; head: the angle between both heads.'
UNCERTAIN_S = 0.001
"""Smallest uncertainty of the clock offset (s) that the text states."""


def text(found: Comparison, sim: LiveRecording, hw: LiveRecording, exceeded: Sequence[str]) -> str:
    """Return tables, sentences about lag, gaps and clocks, and one for each threshold that was exceeded."""
    return "\n".join([
        axes_table(found.axes),
        AFTER,
        "",
        columns(SAMPLE_HEADS, [sample_row(found, 0, sim), sample_row(found, 1, hw)]),
        "",
        lag_sentence(found),
        *gap_sentences(found, sim, hw),
        *clock_sentences(sim, hw),
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


def sample_row(found: Comparison, index: int, live: LiveRecording) -> tuple[str, ...]:
    """Return the row of one robot in the table of samples."""
    regular = found.regularity[index]
    return (
        f"{live.robot} ({live.twin})",
        str(regular.samples),
        "-" if regular.lost is None else str(regular.lost),
        f"{regular.period_ms:.1f}",
        f"{regular.jitter_ms:.2f}",
        str(regular.gaps),
        f"{regular.longest_ms:.1f}",
        number(found.off_set_points[index], 2),
        "-" if live.slipped is None else str(live.slipped),
    )


def lag_sentence(found: Comparison) -> str:
    """Return a sentence with the lag of the hardware (ms) in the recording and in its motions, or why there is none."""
    if math.isnan(found.lag_s):
        return f"No lag can be measured: {why_no_lag(found)}"
    behind = "behind" if found.lag_s >= 0 else "ahead of"
    sentence = f"The hardware's set points are {abs(found.lag_s) * 1e3:.1f} ms {behind} the simulation's."
    if found.moved:
        lags_ms = sorted(part.lag_s * 1e3 for part in found.moved)
        count = "1 motion" if len(lags_ms) == 1 else f"{len(lags_ms)} motions"
        sentence += f" In {count} the positions lag by {lags_ms[0]:.1f} to {lags_ms[-1]:.1f} ms."
    return sentence


def gap_sentences(found: Comparison, sim: LiveRecording, hw: LiveRecording) -> list[str]:
    """Return a sentence with the compared part of the shared time; no sentence if all of it was compared."""
    times = sim.recording.t, hw.recording.t
    shared_s = min(t[-1] for t in times) - max(t[0] for t in times)
    if shared_s - found.seconds < HOLE_S:
        return []
    return [
        (
            f"{found.seconds:.1f} s of {shared_s:.1f} s were compared: the longest part in which both robots published "
            f"without a gap of more than {HOLE_S:g} s."
        )
    ]


def clock_sentences(sim: LiveRecording, hw: LiveRecording) -> list[str]:
    """Return a sentence with the uncertainty of the clock offset; no sentence if it is below UNCERTAIN_S."""
    bound_s = sim.clock_s + hw.clock_s
    if bound_s < UNCERTAIN_S:
        return []
    return [
        f"The offset of the two clocks is known to ±{bound_s * 1e3:.1f} ms, so the lag has the same uncertainty."
    ]


def as_document(
    found: Comparison, sim: LiveRecording, hw: LiveRecording, exceeded: Sequence[str]
) -> Mapping[str, object]:
    """Return a comparison for JSON output; keys of quantities end with the unit.

    Axes are in deg, but their lags in s. NaN, which is null in JSON, means not measured.
    """
    return {
        "result": not exceeded,
        "message": lag_sentence(found),
        "exceeded": list(exceeded),
        "robot": sim.robot,
        "moved": found.anything_moved,
        "lag_s": found.lag_s,
        "compared_s": found.seconds,
        "clocks_known_to_s": sim.clock_s + hw.clock_s,
        "motions": [part._asdict() for part in found.moved],
        "axes_deg": msgspec.to_builtins(found.axes),
        "robots": [
            {
                "on": live.twin,
                **msgspec.to_builtins(found.regularity[index]),
                "off_set_points_deg": found.off_set_points[index],
                "missed_steps": live.slipped,
            }
            for index, live in enumerate((sim, hw))
        ],
    }
