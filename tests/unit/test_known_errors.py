"""Known errors of the hardware are found by the comparison, and no others; the table is that of tools/known_errors.py."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import known_errors
import pytest
from known_errors import VARIANTS, Case, Variant, compared, wrong
from known_robots import Known, acts, as_recordings

from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.series import part_of

CASES = {case.name: case for case in known_errors.cases()}
MEMORY = [variant for variant in VARIANTS if not variant.file]
(FILE,) = (variant for variant in VARIANTS if variant.file)
FROM_FILE = ("none", "long misses a step at 13 s", "short and middle exchanged", "leads of 0, 0.5 and 1.5 s")


@pytest.mark.parametrize("variant", MEMORY, ids=lambda variant: variant.name)
@pytest.mark.parametrize("case", CASES.values(), ids=CASES.keys())
def test_a_known_error_and_no_other_is_found(case: Case, variant: Variant, tmp_path: Path) -> None:
    assert wrong(case, variant, compared(case, variant, tmp_path)) == []


@pytest.mark.parametrize("name", FROM_FILE)
def test_a_known_error_is_found_in_a_recording_of_which_samples_are_missing(
    name: str, tmp_path: Path
) -> None:
    assert wrong(CASES[name], FILE, compared(CASES[name], FILE, tmp_path)) == []


@pytest.mark.parametrize("told", [True, False])
def test_a_motion_that_began_before_the_recording_has_its_lead_only_from_its_request(told: bool) -> None:
    both = as_recordings((Known("sim"), Known("hw")), acts(0.5, 2.8), 24.5, events=True)
    cut = [part_of(each, 1.4, 24.5) for each in both]
    if not told:
        cut = [
            replace(each, requests=tuple(request for request in each.requests or () if request.t > 1.6))
            for each in cut
        ]
    found = compare(*cut)
    assert found.lag_s == pytest.approx(0.0, abs=0.005)
    assert [part.measured for part in found.moved] == [told, *[True] * 7]
    assert max(axis.rms_after for axis in found.axes) < 0.3
