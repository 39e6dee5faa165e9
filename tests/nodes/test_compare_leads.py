"""A motion with a lead that is aborted on real robots: the comparison finds that the hardware was never asked."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
from late_tests import Late
from robots import Stage, until

from beatrix_zenoh import Interrupted, Twin
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.arm_causes import Cause
from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.diagnosis import findings
from beatrix_zenoh.recording.series import LiveRecording, record_robots

RMS_DEG, REST_DEG = 0.15, 0.3
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


def late(value: float, limit: float, what: str) -> None:
    """Raise Late if a value that pauses of this computer worsen is above its limit."""
    if not value <= limit:
        raise Late(what, value, limit)


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
