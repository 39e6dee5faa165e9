"""Both robots with leads, a changed lead and an aborted motion: the comparison finds what was asked and what happened."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from late_tests import Late
from robots import Stage, until

from beatrix_zenoh import Interrupted, Twin
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.compare import Comparison, compare
from beatrix_zenoh.recording.diagnosis import findings
from beatrix_zenoh.recording.finding import Cause
from beatrix_zenoh.recording.motion_shifts import MovedPart
from beatrix_zenoh.recording.record_robots import LiveRecording, record_robots
from beatrix_zenoh.recording.series import Floats

LEADS_S = (0.0, 0.5, 1.5)
POSES = ((20.0, 5.0, 0.0), (-15.0, 0.0, 6.0), (10.0, -6.0, -4.0))
LAG_S, RMS_DEG, REST_DEG = 0.005, 0.15, 0.3
LEAD_ASKED_S = 0.2
"""A busy computer sends requests late; on a quiet one the hardware begins within 20 ms of the lead."""
GAP_MS = 100.0
REST_S = 0.5

pytestmark = pytest.mark.measures_time


def recorded_during(
    stage: Stage, seconds: float, do: Callable[[], object]
) -> tuple[LiveRecording, LiveRecording]:
    """Record simulation and hardware for `seconds` (s) during a call."""
    robots = [stage.robot("bea", side, "eve") for side in ("sim", "hw")]
    recording = threading.Event()
    with ThreadPoolExecutor(1) as pool:
        done = pool.submit(record_robots, robots, seconds, lambda _passed_s: recording.set())
        until(recording.is_set, "the recording has begun")
        do()
        sim, hw = done.result(seconds + 20)
    return sim, hw


def rest() -> None:
    """Let the robots rest between two motions, so that the recording shows where each ends."""
    threading.Event().wait(REST_S)


def apart_s(sim: LiveRecording, hw: LiveRecording, part: MovedPart) -> float:
    """Return the median time (s) between simulation and hardware at several angles on the way of a motion."""
    one, other = sim.recording, hw.recording
    begin, end = (int(np.searchsorted(one.t, t)) for t in (part.begin_s, part.end_s))
    ways = one.angles[end - 1, :3] - one.angles[begin, :3]
    arm = int(np.argmax(np.abs(ways)))
    levels = one.angles[begin, arm] + ways[arm] * np.linspace(0.2, 0.8, 13)
    first = crossings_s(one.t[begin:end], one.angles[begin:end, arm], levels)
    kept = slice(*np.searchsorted(other.t, (part.begin_s + part.shift_s, part.end_s + part.shift_s)))
    return float(np.median(crossings_s(other.t[kept], other.angles[kept, arm], levels) - first))


def crossings_s(t: Floats, angles: Floats, levels: Floats) -> Floats:
    """Return the times at which an arm that turns in one direction reaches angles (deg)."""
    rising = 1 if angles[-1] > angles[0] else -1
    return np.interp(rising * levels, np.maximum.accumulate(rising * angles), t)


def check_lag(sim: LiveRecording, hw: LiveRecording, found: Comparison) -> None:
    """Check the shift of each motion against the times of single angles, and all differences."""
    for part in found.moved:
        if part.why:
            late(max(each.longest_ms for each in found.regularity), GAP_MS, "longest gap of the positions")
        assert not part.why
        late(abs(part.shift_s - apart_s(sim, hw, part)), LAG_S, "error of a lag")
    late(max(axis.rms_after for axis in found.axes), RMS_DEG, "rms after removal")
    assert max(axis.at_rest for axis in found.axes[: len(ARMS)]) < REST_DEG


def late(value: float, limit: float, what: str) -> None:
    """Raise Late if a value that pauses of this computer worsen is above its limit."""
    if not value <= limit:
        raise Late(what, value, limit)


def leads(found: Comparison) -> list[float]:
    """Return the leads (s) that were asked for."""
    return [round(part.lead_s or 0.0, 3) for part in found.moved]


def lead_error_s(part: MovedPart) -> float:
    """Return by how much the measured lead of a motion differs from the one that was asked for (s)."""
    return abs(part.shift_s - (part.lead_s or 0.0))


@pytest.mark.long("figures of ten seconds of motions")
def test_leads_and_lags_of_both_robots_are_told_apart(stage: Stage, twin: Twin) -> None:
    def moves() -> None:
        for pose, lead_s in zip(POSES, LEADS_S, strict=True):
            twin.preview(*pose, speed=60).commit(lead_s=lead_s)
            rest()

    sim, hw = recorded_during(stage, 10.0, moves)
    found = compare(sim.recording, hw.recording)
    assert leads(found) == list(LEADS_S)
    assert findings(found) == []
    check_lag(sim, hw, found)
    assert max(map(lead_error_s, found.moved)) < LEAD_ASKED_S


@pytest.mark.long("figures of ten seconds of motions")
def test_a_motion_that_the_hardware_never_received_is_no_difference(stage: Stage, twin: Twin) -> None:
    def moves() -> None:
        plan = twin.preview(20, speed=60)
        motion = plan.commit(lead_s=5.0, wait=False)
        until(lambda: twin.sim.positions().head[0] > 5, "the simulation moves")
        plan.abort()
        with pytest.raises(Interrupted):
            motion.result(10)
        rest()
        twin.preview(-15, 0, 5, speed=60).commit()
        rest()
        twin.preview(10, 5, 0, speed=60).commit()
        rest()

    sim, hw = recorded_during(stage, 8.0, moves)
    found = compare(sim.recording, hw.recording)
    (finding,) = findings(found)
    assert (finding.cause, finding.value) == (Cause.NOT_ASKED, 1)
    assert "aborted before the hardware was asked" in finding.sentence
    late(max(axis.rms_after for axis in found.axes), RMS_DEG, "rms after removal")
    assert max(axis.at_rest for axis in found.axes[: len(ARMS)]) < REST_DEG
