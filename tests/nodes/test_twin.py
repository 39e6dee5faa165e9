"""Motions of both robots of one name: a preview, then the simulation, then the hardware."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from robots import Stage, until

from beatrix_zenoh import Interrupted, NoAnswer, Refused, Robot, Twin
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason


@pytest.fixture
def twin(stage: Stage) -> Iterator[Twin]:
    """Both robots, enabled and calibrated, without an emergency latch."""
    with Twin("bea", connect=stage.endpoint, who="ana") as made:
        made.stop()
        made.sim.reset()
        made.hw.reset()
        made.disable()
        made.enable()
        made.calibrate()
        yield made
        made.stop()


def commanded(robot: Robot) -> tuple[float, float, float]:
    return robot.positions().commanded


def test_a_preview_moves_nothing_and_is_faster_than_the_motion(twin: Twin) -> None:
    began_s = time.monotonic()
    plan = twin.preview(yaw=60, pitch=-10)
    assert time.monotonic() - began_s < plan.duration
    assert plan.duration == pytest.approx(2.2, abs=0.3)
    assert plan.path.head[-1] == pytest.approx((60, -10, 0), abs=0.5)
    assert plan.path.t == sorted(plan.path.t)
    assert commanded(twin.sim) == commanded(twin.hw) == (0, 0, 0)
    plan.abort()
    with pytest.raises(Refused, match="aborted already"):
        plan.commit()


def test_commit_moves_both_robots_to_one_place_and_the_simulation_first(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    accepted: list[str] = []
    begin = Robot.begin

    def record(robot: Robot, query: MotionQuery | PoseQuery) -> Motion:
        motion = begin(robot, query)
        accepted.append(robot.side)
        return motion

    monkeypatch.setattr(Robot, "begin", record)
    plan = twin.preview(yaw=20, pitch=8, speed=60)
    plan.commit()
    assert commanded(twin.sim) == commanded(twin.hw)
    until(lambda: twin.sim.positions().head == pytest.approx(plan.path.head[-1], abs=0.3), "as previewed")
    assert accepted == ["sim", "hw"]
    with pytest.raises(Refused, match="committed already"):
        plan.abort()


def test_a_plan_is_refused_when_a_robot_has_moved_since(twin: Twin) -> None:
    plan = twin.preview(yaw=10)
    twin.sim.look(yaw=-3, speed=60)
    with pytest.raises(Refused, match=r"bea \(sim\) has moved.*preview again"):
        plan.commit()
    assert commanded(twin.hw) == (0, 0, 0)
    twin.sim.home()
    plan = twin.preview(yaw=10)
    twin.hw.look(yaw=-3, speed=60)
    with pytest.raises(Refused, match=r"bea \(hw\) has moved.*preview again"):
        plan.commit()
    assert commanded(twin.sim) == (0, 0, 0)


def test_only_a_relative_plan_needs_both_robots_at_one_position(twin: Twin) -> None:
    twin.hw.look(yaw=20, speed=60)
    with pytest.raises(Refused, match=r"20\.\d° apart"):
        twin.preview(yaw=5, relative=True)
    twin.preview(yaw=5, speed=60).commit()
    twin.preview(yaw=5, speed=60, relative=True).commit()
    assert commanded(twin.sim) == commanded(twin.hw)


def test_hardware_that_may_not_move_is_detected_before_the_simulation_moves(twin: Twin) -> None:
    plan = twin.preview(yaw=60)
    twin.hw.disable()
    with pytest.raises(Refused, match=r"bea \(hw\): The motors are off") as refusal:
        plan.commit()
    assert refusal.value.reason is Reason.NOT_ENABLED
    before = twin.sim.status().motion
    assert "committed" not in repr(plan)
    assert (twin.sim.status().motion, commanded(twin.sim)) == (before, (0, 0, 0))


def test_while_another_seat_drives_one_robot_both_stay_as_they_are_and_its_motion_goes_on(
    stage: Stage, twin: Twin
) -> None:
    bob = stage.robot("bea", "hw", "bob")
    until(lambda: twin.hw.status().holder == "", "lease over")
    plan = twin.preview(yaw=30)
    calibrations = twin.sim.status().calibrations
    motion = bob.look(yaw=15, speed=60, wait=False)
    for verb in (twin.enable, twin.calibrate, plan.commit):
        with pytest.raises(Refused, match=r"^bea \(hw\): bob drives this robot") as refusal:
            verb()
        assert refusal.value.message.count("bea (hw)") == 1
    motion.wait()
    assert not twin.sim.status().moving
    assert twin.sim.status().calibrations == calibrations
    until(lambda: twin.hw.status().holder == "", "lease over")


def test_a_late_refusal_of_the_hardware_stops_the_simulation(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As if the robot were disabled just then.
    monkeypatch.setattr("beatrix_zenoh.client.twin_state.may_move", lambda *_, moves: None)  # noqa: ARG005
    plan = twin.preview(yaw=60)
    twin.hw.disable()
    with pytest.raises(Refused) as refusal:
        plan.commit()
    assert refusal.value.reason is Reason.NOT_ENABLED
    assert not twin.sim.status().moving
    assert commanded(twin.sim)[0] < 30


def test_stop_at_one_robot_stops_the_other(stage: Stage, twin: Twin) -> None:
    other = stage.robot("bea", "hw", "ben")
    plan = twin.preview(yaw=90)
    ended: list[Interrupted] = []

    def commit() -> None:
        try:
            plan.commit()
        except Interrupted as error:
            ended.append(error)

    thread = threading.Thread(target=commit)
    thread.start()
    until(lambda: other.positions().commanded.short > 5, "moving")
    other.stop()
    thread.join()
    assert "bea (hw): Ended by STOP" in ended[0].message
    assert "bea (sim): Stopped;" in ended[0].message
    assert not twin.sim.status().moving
    assert commanded(twin.sim)[0] < 60


def test_the_hardware_is_stopped_when_the_simulation_is_lost(alone: Stage) -> None:
    with Twin("bea", connect=alone.endpoint, who="ana") as twin:
        simulation = alone.simulation("bea")
        alone.node("bea")
        twin.enable()
        twin.calibrate()
        other = alone.robot("bea", "hw", "ben")
        plan = twin.preview(yaw=120)
        with ThreadPoolExecutor(1) as pool:
            committed = pool.submit(plan.commit)
            until(lambda: other.positions().commanded.short > 5, "moving")
            simulation.end(signal.SIGKILL)
            with pytest.raises(NoAnswer):
                committed.result(20)
        assert not other.status().moving
        assert other.positions().commanded.short < 60
