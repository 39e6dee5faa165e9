"""The link of the window: motions of both robots, their end within the lead, and plays."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_links import Linked, is_home, look, rests, short
from present import present
from robots import Stage

from beatrix_zenoh.client import own_gestures
from beatrix_zenoh.client.choreography import ArmPose
from beatrix_zenoh.client.degrees import pose_query
from beatrix_zenoh.client.twin import Plan
from beatrix_zenoh.contract._generated.messages import Reason, Steps
from beatrix_zenoh.contract.errors import Refused
from gui.console.link import request
from gui.console.state.actions import Abort, ChooseRobot, Play, Send, SendStop
from gui.console.state.world import PlanPhase, World

BOTH = ("sim", "hw")
TOO_FAR = pose_query(0.0, 60.0, 0.0, relative=False, speed=60.0)


def steps(linked: Linked, side: str = "hw") -> Steps:
    """Return the set points of a robot, in steps."""
    return present(linked.world.side(side).positions).steps


def leading(linked: Linked, row: int, yaw: float = 60.0, lead_s: float = 5.0) -> World:
    """Send a motion of both robots, and wait until the simulation moves; return the world at the start of the lead."""
    linked.do(Send(row, look(yaw, 30), BOTH, lead_s))
    world = linked.until(
        lambda world: world.plan is not None and world.plan.phase is PlanPhase.LEADING, "the simulation leads"
    )
    linked.until(lambda world: abs(short(world, "sim")) > 1, "the simulation moves")
    assert linked.accepted(row).duration_s > lead_s
    return world


def test_both_robots_move_together_without_a_lead(linked: Linked) -> None:
    linked.do(Send(1, look(12), BOTH))
    accepted = linked.accepted(1)
    assert accepted.message.startswith("Possible")
    end = linked.end_of(1)
    assert (end.accepted, [found.done for found in linked.of(1)]) == (True, [False, True])
    assert linked.world.plan is None
    for side in BOTH:
        linked.until(lambda world, side=side: short(world, side) == pytest.approx(12, abs=0.1), "there")  # type: ignore[misc]


def test_the_hardware_follows_after_the_lead_with_a_countdown(linked: Linked) -> None:
    before = steps(linked)
    world = leading(linked, 1, 20.0, 1.0)
    plan = present(world.plan)
    assert present(plan.path).arms[-1].short == pytest.approx(20, abs=0.1)
    assert 0.5 < plan.countdown_s <= plan.lead_s == 1.0
    assert (plan.apart_deg, plan.alike) == (0.0, True)
    assert steps(linked) == before
    sent = linked.until(
        lambda world: world.plan is not None and world.plan.phase is PlanPhase.SENT, "the hardware follows"
    )
    assert present(sent.plan).countdown_s == 0.0
    assert linked.end_of(1).accepted
    linked.until(lambda world: short(world, "hw") == pytest.approx(20, abs=0.1), "there")


@pytest.mark.parametrize("action", [Abort(), SendStop(2)])
def test_within_the_lead_abort_and_stop_leave_the_hardware_unmoved(
    linked: Linked, action: Abort | SendStop
) -> None:
    before = steps(linked)
    leading(linked, 1)
    linked.do(action)
    end = linked.end_of(1)
    assert (end.accepted, end.reason) == (False, Reason.STOPPED)
    assert "bea (hw): not moved" in end.message
    world = linked.until(lambda world: rests(world, "sim") and world.plan is None, "it rests")
    assert short(world, "sim") < 50
    assert steps(linked) == before


def test_the_newest_of_many_motions_is_carried_out_and_each_row_ends_once(linked: Linked) -> None:
    for row in range(10):
        linked.do(Send(row, look(row, 60), BOTH))
    assert linked.end_of(9).accepted
    for row in range(9):
        assert linked.end_of(row).reason is Reason.REPLACED
        assert len([found for found in linked.of(row) if found.done]) == 1


def test_selecting_another_robot_ends_the_motions_of_this_window(linked: Linked) -> None:
    """STOP of this window then goes to the other robot."""
    before = steps(linked)
    leading(linked, 1)
    linked.do(ChooseRobot("other"))
    assert linked.end_of(1).key == "result.deselected"
    linked.do(ChooseRobot("bea"))
    linked.online(*BOTH)
    assert steps(linked) == before
    assert short(linked.world, "sim") < 50
    linked.do(Send(2, look(90, 20), ("hw",)))
    linked.until(lambda world: short(world, "hw") > 1, "the hardware moves")
    linked.do(ChooseRobot("other"))
    linked.do(ChooseRobot("bea"))
    linked.online(*BOTH)
    linked.until(lambda world: rests(world, "hw"), "it rests")
    assert short(linked.world, "hw") < 60


def test_the_end_of_the_window_within_the_lead_leaves_the_hardware_unmoved(
    linked: Linked, stage: Stage
) -> None:
    before = steps(linked)
    leading(linked, 1, lead_s=0.6)
    linked.close()
    with Linked(stage.endpoint) as other:
        other.online(*BOTH)
        other.until(lambda world: world.sim.status is not None and not world.sim.status.holder, "it is free")
        assert steps(other) == before
        assert short(other.world, "sim") < 50


def test_a_motion_of_both_is_carried_out_although_one_robot_still_moves(linked: Linked) -> None:
    linked.do(Send(1, look(-10, 20), ("hw",)))
    linked.until(lambda world: abs(short(world, "hw")) > 1, "it moves")
    linked.do(Send(2, TOO_FAR, BOTH))
    assert linked.end_of(2).reason is Reason.OUT_OF_REACH
    linked.do(Send(3, look(4), BOTH))
    assert linked.end_of(3).accepted


def test_a_motion_whose_preview_stays_obsolete_is_refused_with_the_cause(
    linked: Linked, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise Refused(Reason.REPLACED, "bea (sim) has moved since this preview.")

    monkeypatch.setattr(request, "REST_S", 0.2)
    monkeypatch.setattr(Plan, "commit", refuse)
    linked.do(Send(1, look(4), BOTH))
    end = linked.end_of(1)
    assert (end.accepted, end.reason, end.key) == (False, Reason.NOT_AT_REST, "result.moved")


# -- choreographies -------------------------------------------------------------------------------


def turns(speed: float, *yaws: float) -> tuple[ArmPose, ...]:
    """Return poses (deg), one after the other at a speed (deg/s)."""
    return tuple(ArmPose(0.0, yaw, yaw, yaw, speed) for yaw in yaws)


def test_poses_are_played_one_after_the_other(linked: Linked) -> None:
    linked.do(Play(1, ("sim",), poses=turns(60.0, 10.0, -5.0)))
    assert linked.world.playing == "poses"
    linked.until(lambda world: short(world, "sim") > 9, "the first pose")
    linked.until(lambda world: world.playing_pose == 1, "the second pose")
    assert linked.end_of(1, "sim").accepted
    world = linked.until(lambda world: not world.playing, "it has ended")
    assert short(world, "sim") == pytest.approx(-5, abs=0.1)


@pytest.mark.long("plays in real time")
def test_a_gesture_moves_both_heads_and_ends_at_home(linked: Linked) -> None:
    linked.do(Play(1, BOTH, gesture="yes"))
    for side in BOTH:
        linked.until(lambda world, side=side: abs(short(world, side)) > 5, f"{side} nods")  # type: ignore[misc]
    assert linked.end_of(1).accepted
    assert all(is_home(linked.world.side(side)) for side in BOTH)


@pytest.mark.long("plays in real time")
def test_a_loop_is_played_until_a_newer_motion(linked: Linked) -> None:
    linked.do(Play(1, ("sim",), poses=turns(80.0, 8.0), again=turns(80.0, -8.0, 8.0)))
    linked.until(lambda world: short(world, "sim") > 7, "the first round")
    for _ in range(2):
        linked.until(lambda world: short(world, "sim") < -7, "the loop")
        linked.until(lambda world: short(world, "sim") > 7, "the loop")
    assert max(outcome.rounds for outcome in linked.outcomes if outcome.row == 1) >= 2
    linked.do(Send(2, look(0, 60), ("sim",)))
    assert linked.end_of(2, "sim").accepted
    assert linked.end_of(1, "sim").reason is Reason.REPLACED


def test_stop_ends_a_choreography_of_both_robots(linked: Linked) -> None:
    linked.do(Play(1, BOTH, poses=turns(30.0, 40.0, -40.0, 0.0)))
    linked.accepted(1)
    linked.until(lambda world: short(world, "sim") > 2 and short(world, "hw") > 2, "both move")
    linked.do(SendStop(2))
    assert (linked.end_of(1).reason, linked.end_of(1).key) == (Reason.STOPPED, "result.stop_pressed")
    world = linked.until(lambda world: not world.playing and rests(world, "hw"), "it has ended")
    assert short(world, "hw") < 39


def test_a_gesture_of_the_user_is_played_or_refused_with_the_line_of_the_error(
    linked: Linked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    own_gestures.folder().mkdir(parents=True)
    head = "t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n"
    files = {
        "nod": head + "0,0,0,0,30\n0.5,6,0,0,\n",
        "high": head + "0,0,80,0,30\n",
        "broken": head + "0,x,0,0,9\n",
    }
    for name, text in files.items():
        (own_gestures.folder() / f"{name}.csv").write_text(text, encoding="utf-8")
    linked.do(Play(1, ("sim",), gesture="nod"))
    assert linked.world.playing == "nod"
    assert linked.end_of(1, "sim").accepted
    assert short(linked.world, "sim") == pytest.approx(6, abs=0.2)
    for row, name in ((2, "high"), (3, "broken")):
        linked.do(Play(row, BOTH, gesture=name))
        end = linked.end_of(row)
        assert (end.accepted, "line 2" in f"{end.message}{end.slots}") == (False, True)
    linked.do(Play(4, BOTH, gesture="none"))
    assert linked.end_of(4).key == "result.no_gesture"
