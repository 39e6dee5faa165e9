"""Compare robots with known errors; print truth, figure and sentence of each, and fail if one is not found.

Each row is compared as it is, with noise, with lost samples, and from a recording's file.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from known_arm_cases import Case
from known_cases import cases
from known_robots import as_recordings, from_file

from beatrix_zenoh.output import columns
from beatrix_zenoh.recording.causes import Cause, Finding, findings
from beatrix_zenoh.recording.compare import Comparison, compare
from beatrix_zenoh.recording.verbs.comparison_text import lag_sentence, lead_sentences

SECONDS = 21.0
LAG_S, LEAD_S, RMS_DEG = 0.005, 0.02, 0.15
NOISE_DEG, LOST = 0.1, 0.1
FEW_S = 0.1
"""Of publications with longer periods (s) there are too few to lose an exact share."""
TOLERANCE = {Cause.OFFSET: 0.05, Cause.LOSS: 0.03}
"""How much the figure of a finding may differ from the truth; 0 of all others."""


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


def compared(case: Case, variant: Variant, folder: Path) -> Comparison:
    """Carry a case out and compare both robots."""
    sim, hardware = (
        replace(each, noise_deg=max(each.noise_deg, variant.noise_deg), events=[])
        for each in (case.sim, case.hw)
    )
    hardware = replace(hardware, lost=variant.lost)
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
    share = LOST if case.hw.period_s < FEW_S else math.nan
    countable = not (
        variant.file and case.hw.jump[1] < 0
    )  # numbers that alternate look like those of two programs
    expected = list(case.found) + [(Cause.LOSS, "", share)] * bool(variant.lost and countable)
    got = findings(found)
    for cause, arm, value in expected:
        if not any(fits(finding, cause, arm, value) for finding in got):
            result.append(f"not found: {cause} {arm} {value:g}")
    surplus = [each.sentence for each in got if not any(fits(each, *one) for one in expected)]
    result += [f"not said: {case.said}"] * (case.said not in " ".join(sentences(found)))
    for limits, passes in case.checks:
        if bool(exceeded := limits.exceeded(found)) is passes:
            result.append(" ".join(exceeded) or f"within {limits}")
    return [*result, *surplus]


def sentences(found: Comparison) -> list[str]:
    """Return what the comparison says, apart from losses; the last sentence is the most important one."""
    said = [finding.sentence for finding in findings(found) if finding.cause is not Cause.LOSS]
    return [lag_sentence(found), *lead_sentences(found), *said]


def fits(finding: Finding, cause: Cause, arm: str, value: float) -> bool:
    """Return whether a finding is the expected one."""
    near = math.isnan(value) or abs(finding.value - value) <= TOLERANCE.get(cause, 0.0)
    return (finding.cause, "".join(finding.arms)) == (cause, arm) and near


def row(case: Case, found: Comparison, faults: Sequence[str]) -> tuple[str, ...]:
    """Return the row of one case: truth, figures and sentences."""
    lag = "unknown" if math.isnan(found.lag_s) else f"{found.lag_s * 1e3:z.1f} ms"
    truth = "unknown" if math.isnan(case.lag_s) else f"{case.lag_s * 1e3:z.1f} ms"
    rms = max(axis.rms_after for axis in found.axes)
    return (case.name, truth, lag, f"{rms:.2f}", "WRONG" if faults else "ok", sentences(found)[-1])


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
