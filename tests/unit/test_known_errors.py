"""Known errors of the hardware are found by the comparison, and no others; the table is that of tools/known_errors.py."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import known_cases
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from known_arm_cases import Case
from known_errors import VARIANTS, compared, wrong
from known_robots import GOALS, Known, acts, as_recordings
from msgspec import structs

from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.recording.causes import findings
from beatrix_zenoh.recording.compare import Thresholds, compare
from beatrix_zenoh.recording.requests import homes_set
from beatrix_zenoh.recording.series import part_of
from beatrix_zenoh.recording.verbs.comparison_text import as_document, text

CASES = {case.name: case for case in known_cases.cases()}
(NOISE,) = (variant for variant in VARIANTS if variant.name == "noise")
ALWAYS = (
    "none",
    "delay of 200 ms",
    "short 0.5° off",
    "long moves 5 % more",
    "short and middle exchanged",
    "stood still",
    "began 12.4° apart",
    "leads of 0, 0.5 and 1.5 s",
    "aborted in its lead",
    "stopped on the hardware",
    "long misses 2 steps at 8 s and 3 at 17 s",
    "one of two arms 100 ms late",
    "clock jumps by 0.5 s",
)
"""Errors that `make test` looks for, one of each kind."""
LONG = pytest.mark.long("all known errors again; tools/known_errors.py prints them")


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, id=name, marks=() if name in ALWAYS else LONG) for name, case in CASES.items()],
)
def test_a_known_error_and_no_other_is_found(case: Case, tmp_path: Path) -> None:
    assert wrong(case, NOISE, compared(case, NOISE, tmp_path)) == []


@pytest.mark.parametrize("told", [True, False])
def test_a_motion_that_began_before_the_recording_has_its_lead_only_from_its_request(told: bool) -> None:
    both = as_recordings((Known("sim"), Known("hw")), acts(0.5, 2.8), 24.5, events=True)
    cut = [part_of(each, 1.4, 24.5) for each in both]
    if not told:
        cut = [
            replace(each, requests=tuple(request for request in each.requests if request.t > 1.6))
            for each in cut
        ]
    found = compare(*cut)
    assert found.lag_s == pytest.approx(0.0, abs=0.005)
    assert [not part.why for part in found.moved] == [told, *[True] * 7]
    assert max(axis.rms_after for axis in found.axes) < 0.3


def test_the_pause_between_requests_to_each_robot_is_no_lag() -> None:
    pause_s = 0.8
    usual = acts(period_s=2.8)
    third = usual[3]
    requested = [act for act in usual if act is not third]
    requested += [
        replace(third, on="sim", lead_s=None),
        replace(third, on="hw", t=third.t + pause_s, lead_s=None),
    ]
    found = compare(*as_recordings((Known("sim"), Known("hw")), requested, 24.5, events=True))
    (separate,) = (part for part in found.moved if part.why)
    assert separate.why == f"the robots were asked separately, {pause_s:.1f} s apart"
    assert separate.shift_s == pytest.approx(pause_s, abs=0.02)
    assert (found.lag_s, max(axis.rms_after for axis in found.axes)) == pytest.approx((0.0, 0.0), abs=0.3)
    assert findings(found) == []


def test_motions_that_the_simulation_made_by_following_are_compared() -> None:
    sim, hw = as_recordings((Known("sim"), Known("hw", late_s=-0.03)), acts(), 24.5, events=True)
    alone = tuple(replace(request, lead_s=None) for request in hw.requests)
    found = compare(replace(sim, requests=()), replace(hw, requests=alone))
    assert not found.alone
    assert found.lag_s == pytest.approx(-0.03, abs=0.005)
    assert max(axis.rms_after for axis in found.axes) < 0.3
    assert findings(found) == []


@pytest.mark.parametrize(("action", "seen"), [("@CALNOW", True), ("ENABLE", False)])
def test_another_home_is_no_lost_step(action: str, seen: bool) -> None:
    at_s = 12.7  # both rest
    hw = Known("hw", change=lambda t, angles: angles - np.outer(t >= at_s, (20.0, 10.0, 0.0)))
    both = as_recordings((Known("sim"), hw), acts(), 24.5, events=True)
    event = structs.replace(
        hw.events[0], kind=EventKind.COMMAND, action=action, t_mono_ns=round(at_s * 1e9) + 30_000_000
    )
    homes_s = homes_set([(event.t_mono_ns / 1e9, event)])
    found = compare(both[0], replace(both[1], homes_s=homes_s))
    assert findings(found) == []
    assert (max(axis.rms_after for axis in found.axes) < 0.3) is seen
    assert found.seconds < 13.0 or not seen


def test_a_robot_that_was_not_asked_to_move_is_not_said_to_stand_still() -> None:
    noisy = replace(Known("hw"), noise_deg=0.5)
    assert findings(compare(*as_recordings((Known("sim"), noisy), [], 21.0, events=True))) == []
    swinging = Known("hw", change=lambda t, arms: arms + np.outer(np.sin(t) * 10, (1, 1, 1)))
    assert findings(compare(*as_recordings((Known("sim"), swinging), [], 21.0, events=True))) == []


def spoilt(side: str) -> st.SearchStrategy[Known]:
    """Strategy for robots whose publications are late, noisy, rare or lost."""
    return st.builds(
        Known,
        st.just(side),
        late_s=st.floats(-2.0, 2.0),
        noise_deg=st.sampled_from((0.0, 0.0, 0.1, 0.5, 20.0, math.inf)),
        lost=st.sampled_from((0.0, 0.0, 0.1, 0.9)),
        period_s=st.floats(0.01, 1.0),
        seed=st.integers(0, 99),
    )


@settings(deadline=None, max_examples=20)
@given(
    spoilt("sim"),
    spoilt("hw"),
    st.floats(0.1, 15.0),
    st.integers(0, len(GOALS)),
    st.sampled_from((0.0, None, 1.5)),
    st.booleans(),
)
def test_any_recordings_are_compared_or_refused_with_a_reason(
    sim: Known, hw: Known, seconds: float, motions: int, lead_s: float | None, events: bool
) -> None:
    requested = acts(lead_s, period_s=1.3)[:motions]
    both = as_recordings((sim, hw), requested, seconds, events=events)
    try:
        found = compare(*both)
    except ValueError as error:
        assert re.search("cannot be compared|share", str(error)), error  # noqa: PT017
        return
    exceeded = Thresholds(1.0, 1.0, 1.0, 1.0, 0).exceeded(found)
    if found.compared_s < found.shared_s / 4:
        assert any("could be compared" in sentence for sentence in exceeded)
    assert "nan" not in text(found, exceeded)
    assert json.dumps(as_document(found, exceeded))
