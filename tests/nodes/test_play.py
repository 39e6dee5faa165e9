"""Choreographies on both robots: by the clock, with a lead, and in lockstep."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import pytest
from robots import Stage, until

from beatrix_zenoh import Interrupted, Robot, Twin
from beatrix_zenoh.client.choreography import ArmPose, Choreography, Pose, play
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery


@dataclass
class Begun:
    """A sent motion: robot, time (s), and position of the hardware at that time (deg, long arm)."""

    side: str
    at_s: float
    hardware_deg: float


@pytest.fixture
def begun(twin: Twin, monkeypatch: pytest.MonkeyPatch) -> list[Begun]:
    """All motions in the order in which they are sent."""
    found: list[Begun] = []
    begin = Robot.begin

    def record(robot: Robot, query: MotionQuery | PoseQuery) -> Motion:
        found.append(Begun(robot.side, time.monotonic(), twin.hw.positions().commanded.long))
        return begin(robot, query)

    monkeypatch.setattr(Robot, "begin", record)
    return found


POSES = Choreography(
    [("f", Pose(0.0, 4, 0, 0, 60)), ("f", Pose(0.8, 8, 0, 0, 60)), ("f", ArmPose(1.6, 10, 10, 10, 60))]
)


@pytest.mark.long("plays in real time")
def test_in_lockstep_both_robots_wait_for_the_slower_one(twin: Twin, begun: list[Begun]) -> None:
    twin.hw.look(yaw=-40, speed=90)
    begun.clear()
    titles: list[str] = []
    play(twin, POSES, lambda title, _: titles.append(title), lockstep=True)
    assert [one.side for one in begun] == ["sim", "hw"] * 3
    assert begun[2].hardware_deg == pytest.approx(4, abs=0.1)
    assert begun[4].hardware_deg == pytest.approx(8, abs=0.1)
    assert titles == ["f"] * 3


def test_stop_at_one_robot_ends_the_choreography_on_both_robots(
    stage: Stage, twin: Twin, begun: list[Begun]
) -> None:
    other = stage.robot("bea", "hw", "ben")
    long = Choreography([("f", Pose(0.0, 90, 0, 0, 20)), ("f", Pose(6.0, 0, 0, 0, 20))])
    with ThreadPoolExecutor(1) as pool:
        played = pool.submit(play, twin, long)
        until(lambda: other.positions().commanded.long > 3, "the hardware moves")
        other.stop()
        # Either the event of STOP or the end of the motion may arrive first.
        message = r"(?s)bea \(hw\): (Ended by|ben pressed) STOP.*bea \(sim\): Stopped"
        with pytest.raises(Interrupted, match=message):
            played.result(5)
    assert len(begun) == 2
    assert not twin.sim.status().moving
