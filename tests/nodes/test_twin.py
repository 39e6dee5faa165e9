"""Motions of both robots of one name: a preview, then the simulation, then the hardware."""

from __future__ import annotations

import gc
import signal
import threading
import time
import weakref
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import Mock

import pytest
from robots import Stage, assert_fails, until

from beatrix_zenoh import Interrupted, NoAnswer, Refused, Robot, Twin
from beatrix_zenoh.client.choreography import ArmPose, Choreography, Pose, play
from beatrix_zenoh.client.motion import Motion
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason


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


def test_a_twin_keeps_only_its_last_motion(twin: Twin, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program may run for months, be refused again and again, and replace its motions before they end."""
    kept: list[weakref.ref[TwinMotion]] = []
    start = TwinMotion.start

    def record(motion: TwinMotion, *, wait: bool, begun: Callable[[], None] = lambda: None) -> None:
        kept.append(weakref.ref(motion))
        start(motion, wait=wait, begun=begun)

    monkeypatch.setattr(TwinMotion, "start", record)

    def alive() -> int:
        gc.collect()
        return sum(motion() is not None for motion in kept)

    for yaw in (1, 2, 3, 4):
        twin.preview(yaw=yaw).commit(lead_s=5.0, wait=False)
    until(lambda: alive() <= 2, "a motion and the one that it has replaced are kept")
    twin.stop()
    for yaw in (5, 6, 7):
        plan = twin.preview(yaw=yaw)
        with monkeypatch.context() as refusing:
            refusing.setattr(Robot, "begin", Mock(side_effect=Refused(Reason.STOPPED)))
            assert_fails(lambda plan=plan: plan.commit(wait=False), Refused, Reason.STOPPED)  # type: ignore[misc]
        del plan
    until(lambda: alive() == 1, "only the last motion is kept")
    assert len(kept) == 7


@pytest.mark.long("plays in real time")
def test_in_lockstep_both_robots_wait_for_the_slower_one(twin: Twin, monkeypatch: pytest.MonkeyPatch) -> None:
    sides: list[str] = []
    hardware_deg: list[float] = []
    begin = Robot.begin

    def record(robot: Robot, query: MotionQuery | PoseQuery) -> Motion:
        sides.append(robot.side)
        hardware_deg.append(twin.hw.positions().commanded.long)
        return begin(robot, query)

    twin.hw.look(yaw=-40, speed=90)
    monkeypatch.setattr(Robot, "begin", record)
    poses: list[Pose | ArmPose] = [
        Pose(0.0, 4, 0, 0, 60),
        Pose(0.8, 8, 0, 0, 60),
        ArmPose(1.6, 10, 10, 10, 60),
    ]
    titles: list[str] = []
    play(
        twin,
        Choreography([("f", pose) for pose in poses]),
        lambda title, _: titles.append(title),
        lockstep=True,
    )
    assert sides == ["sim", "hw"] * 3
    assert hardware_deg[2::2] == pytest.approx([4, 8], abs=0.1)
    assert titles == ["f"] * 3


def test_a_plan_is_refused_when_a_robot_has_moved_since(twin: Twin) -> None:
    for moved, other in ((twin.sim, twin.hw), (twin.hw, twin.sim)):
        plan = twin.preview(yaw=10)
        moved.look(yaw=-3, speed=60)
        with pytest.raises(Refused, match=rf"bea \({moved.side}\) has moved.*preview again"):
            plan.commit()
        assert commanded(other) == (0, 0, 0)
        moved.home()


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
    assert_fails(plan.commit, Refused, Reason.NOT_ENABLED, r"bea \(hw\): The motors are off")
    before = twin.sim.status().motion
    assert "committed" not in repr(plan)
    assert (twin.sim.status().motion, commanded(twin.sim)) == (before, (0, 0, 0))


def test_while_another_seat_drives_one_robot_both_stay_as_they_are_and_its_motion_goes_on(
    stage: Stage, twin: Twin
) -> None:
    teacher = stage.robot("bea", "hw", "teacher")
    plan = twin.preview(yaw=30)
    calibrations = twin.sim.status().calibrations
    with teacher.lease():  # needs not wait for the end of the other seat's lease
        motion = teacher.look(yaw=15, speed=60, wait=False)
        for verb in (twin.enable, twin.calibrate, plan.commit):
            with pytest.raises(Refused, match=r"^bea \(hw\): teacher has taken this robot") as refusal:
                verb()
            assert refusal.value.message.count("bea (hw)") == 1
        motion.wait()
    teacher.client.close()
    assert not twin.sim.status().moving
    assert twin.sim.status().calibrations == calibrations
    until(lambda: twin.hw.status().holder == "", "free")


def test_a_late_refusal_of_the_hardware_stops_the_simulation(
    twin: Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As if the robot were disabled just then.
    monkeypatch.setattr("beatrix_zenoh.client.twin_state.may_move", lambda *_, moves: None)  # noqa: ARG005
    plan = twin.preview(yaw=60)
    twin.hw.disable()
    assert_fails(plan.commit, Refused, Reason.NOT_ENABLED)
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
