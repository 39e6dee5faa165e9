"""The lead of the simulation: motions that are sent to the hardware later, or cancelled before that."""

from __future__ import annotations

import signal
from collections.abc import Callable

import pytest
from robots import Stage, assert_fails, raw_positions, until

from beatrix_zenoh import Interrupted, Refused, Robot, Twin
from beatrix_zenoh.client.subscription import Subscription
from beatrix_zenoh.client.twin_motion import TwinMotion
from beatrix_zenoh.contract._generated.messages import Positions, Reason
from sim_node.body import Simulation


def number_of_a_motion(twin: Twin) -> int:
    """Move both robots; return the motion's number at the hardware: a node counts up from a random number."""
    twin.look(yaw=1, speed=60)
    return twin.hw.status().motion


def moves(robot: Robot) -> None:
    until(lambda: robot.positions().commanded.short > 1, f"{robot} moves")


@pytest.mark.parametrize("act", [Robot.stop, Robot.disable])
def test_stopping_or_disabling_the_simulation_at_its_goal_ends_the_lead(
    stage: Stage, twin: Twin, act: Callable[[Robot], object]
) -> None:
    before = raw_positions(twin.hw).steps
    motion = twin.preview(yaw=10, speed=60).commit(lead_s=2.5, wait=False)
    until(lambda: twin.sim.positions().commanded.short == pytest.approx(10, abs=0.1), "there")
    teacher = stage.robot("bea", "sim", "teacher")
    act(teacher)
    with pytest.raises((Interrupted, Refused)):
        motion.result(10)
    assert not motion.hardware_sent
    assert raw_positions(twin.hw).steps == before


def test_abort_within_the_lead_stops_the_simulation_and_leaves_the_hardware_unmoved(twin: Twin) -> None:
    before, number = raw_positions(twin.hw).steps, twin.hw.status().motion
    plan = twin.preview(yaw=90)
    motion = plan.commit(lead_s=5, wait=False)
    moves(twin.sim)
    assert motion.running()
    assert not motion.hardware_sent
    assert 3 < motion.countdown_s < 5
    plan.abort()
    assert (motion.done(), motion.hardware_sent, motion.countdown_s) == (True, False, 0.0)
    cancelled = r"(?s)Cancelled.*bea \(sim\): Stopped.*bea \(hw\): not moved"
    assert_fails(motion.result, Interrupted, Reason.STOPPED, cancelled)
    assert not motion.cancel()
    assert not twin.sim.status().moving
    assert (raw_positions(twin.hw).steps, twin.hw.status().motion) == (before, number)


def first_move_ns(positions: Subscription[Positions]) -> int:
    """Return the time (ns) at which a robot has turned by half a degree, by the common clock of both nodes."""
    for reading in positions:
        if abs(reading.commanded.x) > 0.0087:
            return reading.t_mono_ns
    raise AssertionError


def test_the_hardware_follows_after_the_lead_and_the_lag_is_measured(twin: Twin) -> None:
    ended: list[TwinMotion] = []
    with twin.sim.positions_stream(10.0) as of_sim, twin.hw.positions_stream(10.0) as of_hw:
        motion = twin.preview(yaw=20, speed=60).commit(lead_s=1.0, wait=False)
        motion.add_done_callback(ended.append)
        replies = motion.result(10)
        published_s = (first_move_ns(of_hw) - first_move_ns(of_sim)) / 1e9
    assert published_s == pytest.approx(1.0, abs=0.2), "tools/bench_twin.py prints the exact figure"
    assert motion.lag_s == pytest.approx(published_s, abs=0.03)
    assert (replies.sim.result, replies.hw.result, motion.hardware_sent) == (True, True, True)
    assert twin.sim.positions().commanded == twin.hw.positions().commanded
    until(lambda: ended == [motion], "the callback")


def test_a_plan_committed_within_the_lead_replaces_the_previous_one(twin: Twin) -> None:
    number = number_of_a_motion(twin)
    first = twin.preview(yaw=60, speed=30).commit(lead_s=5, wait=False)
    moves(twin.sim)
    twin.preview(yaw=-10, speed=60).commit(lead_s=0.3)
    with pytest.raises(Interrupted) as end:
        first.result(10)
    assert (end.value.reason, first.hardware_sent) == (Reason.REPLACED, False)
    assert twin.hw.status().motion == number + 1
    assert twin.hw.positions().commanded == twin.sim.positions().commanded
    assert twin.hw.positions().commanded.short == pytest.approx(-10, abs=0.1)


@pytest.mark.parametrize("side", ["sim", "hw"])
def test_stop_at_either_robot_within_the_lead_ends_the_motion(stage: Stage, twin: Twin, side: str) -> None:
    before = raw_positions(twin.hw).steps
    other = stage.robot("bea", side, "ben")
    motion = twin.preview(yaw=90).commit(lead_s=5, wait=False)
    moves(twin.sim)
    other.stop()
    assert_fails(lambda: motion.result(4), Interrupted, Reason.STOPPED, r"(?s)STOP.*bea \(hw\): not moved")
    assert raw_positions(twin.hw).steps == before
    assert not twin.sim.status().moving


def turn(robot: Robot) -> None:
    robot.look(yaw=-3, speed=60)


@pytest.mark.parametrize(("change", "message"), [(Robot.disable, "motors are off"), (turn, "has moved")])
def test_changed_hardware_is_not_moved_after_the_lead(
    twin: Twin, change: Callable[[Robot], object], message: str
) -> None:
    number = number_of_a_motion(twin)
    motion = twin.preview(yaw=90, speed=30).commit(lead_s=1.5, wait=False)
    change(twin.hw)
    with pytest.raises(Refused, match=rf"(?s)bea \(hw\).*{message}.*bea \(sim\): Stopped"):
        motion.result(10)
    assert twin.hw.status().motion == number + (change is turn)
    assert not twin.sim.status().moving


def test_send_now_sends_the_motion_to_the_hardware_at_once(twin: Twin) -> None:
    motion = twin.preview(yaw=10, speed=30).commit(lead_s=30, wait=False)
    assert motion.countdown_s > 29
    assert motion.send_now()
    until(lambda: motion.hardware_sent, "the motion is sent to the hardware")
    assert not motion.send_now(), "the motion was sent"
    assert motion.result(10).hw.result
    assert twin.hw.positions().commanded == twin.sim.positions().commanded


def test_hardware_that_is_replaced_during_the_lead_is_not_moved(alone: Stage) -> None:
    alone.node("bea", Simulation("bea"))
    first = alone.hardware("bea")
    with Twin("bea", connect=alone.endpoint, who="ana") as twin:
        twin.make_ready()
        motion = twin.preview(yaw=20, speed=60).commit(lead_s=4.0, wait=False)
        first.send(signal.SIGKILL)
        first.wait()
        alone.node("bea")
        with pytest.raises(Refused, match=r"bea \(hw\): The motors are off"):
            motion.result(12)
        assert twin.hw.positions().commanded.short == 0
