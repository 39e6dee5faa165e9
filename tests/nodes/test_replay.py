"""Recorded motions on real robots: compared, recorded as motion files and replayed, refused, stopped."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from late_tests import Late
from robots import Stage, raw_positions, until

from beatrix_zenoh import Interrupted, Refused, Robot, Twin
from beatrix_zenoh.client import motion_file
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.paths.follow import Following, follow
from beatrix_zenoh.paths.path import path_of
from beatrix_zenoh.paths.replay import LATE_S, Progress
from beatrix_zenoh.paths.replay import replay as replay_now
from beatrix_zenoh.recording.compare import compare
from beatrix_zenoh.recording.series import Recording, record_robots

NOD = """t_s,yaw_deg,pitch_deg,roll_deg
0.0,0,0,0
0.6,0,10,0
1.2,0,10,0
2.0,15,-5,0
3.0,0,0,0
"""
OFF_DEG, CUT_DEG = 1.0, 5.0
"""Tolerances of a replay's path, of nine in ten set points and of all: after a pause of the computer the arms go
straight to the next target and cut a corner. tools/bench_twin.py measures how well the path is followed in time."""
PAUSE_S = 0.4
"""A pause of the computer that does not disturb the check of a path."""

pytestmark = pytest.mark.measures_time  # a replay ends if the computer stands still for LATE_S


def replay(
    robots: Twin | Robot,
    following: Following,
    progress: Progress = lambda _passed_s: None,
    *,
    lead_s: float = 0.0,
) -> None:
    """Replay a path; raise Late if it ended because the computer stood still."""
    try:
        replay_now(robots, following, progress, lead_s=lead_s)
    except Interrupted as error:
        if paused := re.search(r"suspended for ([\d.]+) s", error.message):
            raise Late("delay of a target", float(paused[1]), LATE_S) from error
        raise


def following(text: str) -> Following:
    """Return the targets that follow the path of a motion file."""
    return follow(path_of(motion_file.parse(text, "nod.csv"), MotionLimits()), ROBOT)


def recorded_during(stage: Stage, seconds: float, do: Callable[[], object]) -> tuple[Recording, Recording]:
    """Record both robots for `seconds` during a call; return the recordings of simulation and hardware."""
    robots = [stage.robot("bea", side, "eve") for side in ("sim", "hw")]
    with ThreadPoolExecutor(1) as pool:
        recording = pool.submit(record_robots, robots, seconds)
        until(recording.running, "the recording has begun")
        do()
        sim, hw = recording.result(seconds + 20)
    return sim, hw


def check_path(live: Recording, played: Following) -> None:
    """Check the distances of the set points from the path near their times.

    A pause of the computer shifts what follows it, so each set point is compared with the path within PAUSE_S of its
    time; the times are aligned at the first movement.
    """
    t = np.arange(-0.5, played.path.duration_s + 0.5, 0.005)
    path = played.path.at(t)
    arms = live.arms
    begin = int(np.argmax(np.max(np.abs(arms.angles - arms.angles[0]), axis=1) > 1.0))
    reached = int(np.argmax(np.max(np.abs(path - path[0]), axis=1) > 1.0))
    times = np.clip(arms.t - arms.t[begin] + t[reached], t[0], t[-1])
    near = np.abs(times[:, None] - t) <= PAUSE_S
    apart = np.max(np.abs(arms.angles[:, None, :] - path), axis=2)
    distances = np.min(np.where(near, apart, np.inf), axis=1)
    assert np.quantile(distances, 0.9) < OFF_DEG
    assert np.max(distances) < CUT_DEG


@pytest.mark.long("a path in real time")
def test_both_robots_follow_a_path_and_a_known_lag_and_offset_are_found(stage: Stage, twin: Twin) -> None:
    played = following(NOD)
    sim, hw = recorded_during(stage, 6.0, lambda: replay(twin, played, lead_s=0.1))
    for live in (sim, hw):
        check_path(live, played)
        assert live.arms.angles[-1] == pytest.approx(played.path.arms[-1], abs=0.2)
        assert live.clock_s == 0.0, "both run on this computer"
    assert (sim.slipped, hw.slipped) == (0, None)

    before = compare(sim, hw)
    assert -0.1 < before.lag_s < PAUSE_S, "without the lead: delays of this computer"
    # A pause of the computer may leave a part without request and therefore without lead.
    leads = [part.lead_s for part in before.moved if part.lead_s is not None]
    assert leads == pytest.approx([0.1] * max(1, len(leads)))
    off = hw.angles + np.array([0, 1.5, 0, 0, 0, 0])
    assert hw.commanded is not None
    late = dataclasses.replace(hw, t=hw.t + 0.2, angles=off)
    after = compare(sim, late)
    assert after.lag_s - before.lag_s == pytest.approx(0.2, abs=0.005)
    assert after.axes[1].offset - before.axes[1].offset == pytest.approx(1.5, abs=0.05)
    assert after.axes[1].lag_s - before.axes[1].lag_s == pytest.approx(0.2, abs=0.005)


def test_a_refused_path_moves_no_robot(twin: Twin) -> None:
    before = raw_positions(twin.sim).steps, raw_positions(twin.hw).steps
    with pytest.raises(Refused, match=r"nod\.csv, line 5 \(t = 2\.00 s\): The head would lean 40"):
        replay(twin, following(NOD.replace("15,-5,0", "15,-40,0")))
    twin.hw.disable()
    with pytest.raises(Refused, match="hw"):
        replay(twin, following(NOD))
    assert (raw_positions(twin.sim).steps, raw_positions(twin.hw).steps) == before


SLOW = "t_s,yaw_deg,pitch_deg,roll_deg\n0,0,0,0\n20,60,0,0\n"


def test_stop_by_another_seat_ends_the_replay_on_both_robots(stage: Stage, twin: Twin) -> None:
    other = stage.robot("bea", "sim", "ben")
    with ThreadPoolExecutor(1) as pool:
        played = pool.submit(replay, twin, following(SLOW))
        until(lambda: other.positions().commanded.short > 2, "the simulation moves")
        other.stop()
        with pytest.raises(
            (Interrupted, Refused),
            match=r"bea \(sim\): .*(ben pressed STOP|STOP of ben|STOP was pressed by ben)",
        ):
            played.result(10)
    for robot in (twin.sim, twin.hw):
        until(lambda robot=robot: not robot.status().moving, "it rests")  # type: ignore[misc]
        assert robot.positions().commanded.short < 30
