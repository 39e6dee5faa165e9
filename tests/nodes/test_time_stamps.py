"""Time stamps of positions: exact enough to compare two robots."""

from __future__ import annotations

import statistics
from itertools import pairwise

import numpy as np
import pytest
from robots import Stage, ready, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated.messages import Positions

SPEED_DEG_S = 80.0
GAP_S, ATTEMPTS = 0.1, 5
"""Shortest gap (s) between publications that spoils a recording, and number of recordings."""
CLOCK_SD_S = 0.001
"""Largest standard deviation (s) of the errors of time stamps."""


def recorded(robot: Robot, *yaws: float) -> list[Positions]:
    """Return the positions that a robot publishes while its head turns to these yaws (deg), and move it home.

    If the computer stood still meanwhile, the robot turns again: these tests need a motion without interruption.
    """
    for _ in range(ATTEMPTS):
        published = turned(robot, *yaws)
        times_s = [at.t_mono_ns / 1e9 for at in published]
        if max((later - at for at, later in pairwise(times_s)), default=0.0) < GAP_S:
            return published
    raise AssertionError(f"a gap of {GAP_S} s in each of {ATTEMPTS} motions")


def turned(robot: Robot, *yaws: float) -> list[Positions]:
    with robot.positions_stream() as stream:
        stream.next(5.0)
        for yaw in yaws:
            robot.look(yaw=yaw, speed=SPEED_DEG_S)
        until(lambda: not robot.status().moving, "at rest")
        published = stream.take(0.2)
    robot.home()
    return published


@pytest.mark.long("a figure of make bench")
@pytest.mark.parametrize("side", ["sim", "hw"])
def test_time_stamps_follow_the_set_points_of_a_steady_turn(stage: Stage, side: str) -> None:
    turn = recorded(ready(stage.robot("bea", side)), 90)
    steady = [
        at for at in turn if 25 < np.degrees(at.commanded.x) < 65
    ]  # outside these angles the arms accelerate
    assert len(steady) > 15
    times = np.array([at.t_mono_ns / 1e9 for at in steady])
    angles = np.degrees([at.commanded.x for at in steady])
    rate, offset = np.polyfit(times - times[0], angles, 1)
    assert rate == pytest.approx(SPEED_DEG_S, rel=0.01)
    errors_s = (angles - offset) / rate - (times - times[0])
    assert statistics.stdev(errors_s.tolist()) < CLOCK_SD_S, (
        "rounding to whole microsteps causes 0.3 ms of it"
    )
