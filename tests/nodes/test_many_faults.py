"""A fault of one of several simulations in a process: it is reported and stays down, and the others go on."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from late_tests import in_time
from published import published_positions
from robots import Process, Stage, assert_fails, ready, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Positions, Reason
from beatrix_zenoh.contract.errors import BeatrixError

SCRIPT = Path(__file__).parents[1] / "support/faulty_simulations.py"
NAMES = ("ada", "bob", "eva", "fay")
GAP_S = 0.1
BEFORE = 100
"""Positions of each robot before a fault; on a busy computer their gaps are the measure of those after it."""


@pytest.fixture(scope="module")
def process(router: Stage) -> Process:
    """Several simulations in one process."""
    words = [word for name in NAMES for word in ("--name", name)]
    process = router.script(SCRIPT, *words, "--ready", "--connect", router.endpoint, listens=True)
    for name in NAMES:
        process.expect(f"ready {keys.alive(name, 'sim')}")
    return process


def longest_gap_s(positions: list[Positions]) -> float:
    """Return the longest time (s) between two positions."""
    return max(after.t_mono_ns - before.t_mono_ns for before, after in pairwise(positions)) / 1e9


@pytest.mark.measures_time
def test_a_robot_that_fails_stays_down_and_the_others_go_on(router: Stage, process: Process) -> None:
    """One robot fails in the thread that all share, one in a thread of its own."""
    others = [published_positions(router.robot(name, "sim", "watcher")) for name in ("ada", "fay")]
    until(lambda: all(len(one.all) > BEFORE for one in others), "positions of the others")
    before_s = max(longest_gap_s(one.all) for one in others)
    ada, eva = ready(router.robot("ada", "sim")), ready(router.robot("eva", "sim"))
    process.say("raise bob")
    process.expect("bob: It has failed (RuntimeError: put in by a test) and stays down")
    process.say("calibrate eva")
    assert_fails(lambda: calibrate_until_lost(eva), BeatrixError, Reason.NODE_LOST)
    process.expect("eva: It has failed (RuntimeError: put in by a test) and stays down")
    for one in others:
        gap_s = longest_gap_s(one.all[BEFORE:])
        in_time(gap_s, max(GAP_S, 2 * before_s), f"gap in the positions of {one.robot}")
    assert [name for name, _ in router.client().bus.robots()] == ["ada", "fay"]
    assert ada.status().calibrated
    assert process.end() == 70


def calibrate_until_lost(robot: Robot) -> None:
    """Calibrate until there is no reply, because the fault is put in a moment after the test asks for it."""
    while True:
        robot.calibrate()
