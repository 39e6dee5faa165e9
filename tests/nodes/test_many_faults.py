"""A fault of one of several simulations in a process: it is reported and started anew, and the others go on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from late_tests import in_time, within
from robots import Process, Stage, ready, until, wait_status

from beatrix_zenoh import Robot
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Positions, Reason
from beatrix_zenoh.contract.errors import BeatrixError

SCRIPT = Path(__file__).parents[1] / "support/faulty_simulations.py"
NAMES = ("ada", "bob", "eva", "fay")
GAP_S = 0.1
BEFORE = 100
"""Positions of each robot before a fault; on a busy computer their gaps are the measure of those after it."""
ANEW_S = 1.0


@pytest.fixture(scope="module")
def stage() -> Iterator[Stage]:
    with Stage() as made:
        yield made


@pytest.fixture(scope="module")
def process(stage: Stage) -> Process:
    """Several simulations in one process; each test lets another one fail."""
    words = [word for name in NAMES for word in ("--name", name)]
    process = stage.script(SCRIPT, *words, "--ready", "--connect", stage.endpoint, listens=True)
    for name in NAMES:
        process.expect(f"ready {keys.alive(name, 'sim')}")
    return process


class Watched:
    """Times of the positions of all robots but one."""

    def __init__(self, stage: Stage, name: str) -> None:
        self.times: dict[str, list[int]] = {}
        self._name = name
        bus = stage.client("watcher").bus
        bus.subscribe(keys.positions("*", "sim"), lambda got: self._hear(got.key, got.payload))
        until(
            lambda: len(self.times) == len(NAMES) - 1 and min(map(len, self.times.values())) > BEFORE,
            "positions of all others",
        )
        self._before_s = max(longest_gap_s(times) for times in self.times.values())

    def _hear(self, key: str, payload: bytes) -> None:
        name = key.split("/")[1]
        if name != self._name:
            self.times.setdefault(name, []).append(codec.decode(payload, Positions).t_mono_ns)

    def check(self) -> None:
        """Check that no robot has a gap since the fault."""
        for name, times in self.times.items():
            gap_s = longest_gap_s(times[BEFORE:])
            in_time(gap_s, max(GAP_S, 2 * self._before_s), f"gap in the positions of {name}")


def longest_gap_s(times: list[int]) -> float:
    """Return the longest time (s) between two positions, of their times (ns)."""
    return max(after - before for before, after in pairwise(times)) / 1e9


@pytest.mark.long("starts a robot several times")
@pytest.mark.measures_time
def test_a_robot_that_fails_is_started_anew_and_the_others_go_on(stage: Stage, process: Process) -> None:
    name = "bob"
    watched = Watched(stage, name)
    process.say(f"raise {name}")
    process.expect(f"{name}: The program of {name} had failed")
    client = stage.client()
    with within(ANEW_S, "the robot is started anew"):
        until(lambda: (name, "sim") in client.bus.robots(), "the robot is started anew")
    watched.check()
    anew = stage.robot(name, "sim")
    assert any("put in by a test" in text for text in anew.status().warnings)
    ready(anew).look(yaw=5)
    stage.close_clients()


def calibrate_until_lost(robot: Robot) -> None:
    """Calibrate until there is no reply, because the fault is put in a moment after the test asks for it."""
    while True:
        robot.calibrate()


def test_an_exception_in_a_thread_of_a_robot_replaces_only_this_robot(stage: Stage, process: Process) -> None:
    ada = ready(stage.robot("ada", "sim"))
    eva = ready(stage.robot("eva", "sim"))
    process.say("calibrate eva")
    with pytest.raises(BeatrixError) as lost:
        calibrate_until_lost(eva)
    assert lost.value.reason is Reason.NODE_LOST
    until(lambda: ("eva", "sim") in ada.client.bus.robots(), "eva is started anew")
    wait_status(
        stage.robot("eva", "sim", "ben"),
        lambda status: any("put in by a test" in text for text in status.warnings),
        "eva says why",
    )
    assert ada.status().calibrated
    stage.close_clients()


def test_a_robot_that_fails_again_stays_down(stage: Stage, process: Process) -> None:
    client = stage.client()
    for line in ("fay: The program of fay had failed", "fay stays down"):
        process.say("raise fay")
        process.expect(line)
    until(lambda: ("fay", "sim") not in client.bus.robots(), "fay is gone")
    assert Robot("ada", "sim", client=client).status().board.connected
    assert process.end() == 70
