"""The link of the window: choreographies, and a suspended hardware node."""

from __future__ import annotations

from pathlib import Path

import pytest
from gui_links import Linked, look, short

from beatrix_zenoh.client.choreography import ArmPose
from beatrix_zenoh.contract._generated.messages import Reason
from gui.console.state.actions import Play, Send, SendStop

BOTH = ("sim", "hw")


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
    world = linked.until(lambda world: not world.playing and not world.hw.status.moving, "it has ended")  # type: ignore[union-attr]
    assert short(world, "hw") < 39


def test_a_file_is_played_or_refused_with_the_line_of_the_error(linked: Linked, tmp_path: Path) -> None:
    path, wrong = tmp_path / "nod.csv", tmp_path / "wrong.csv"
    path.write_text("t_s,yaw_deg,pitch_deg,roll_deg\n0,0,0,0\n0.5,6,0,0\n1,6,0,0\n", encoding="utf-8")
    wrong.write_text("t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n0,0,80,0,30\n", encoding="utf-8")
    linked.do(Play(1, ("sim",), path))
    assert linked.world.playing == "nod"
    assert linked.end_of(1, "sim").accepted
    assert short(linked.world, "sim") == pytest.approx(6, abs=0.2)
    linked.do(Play(2, BOTH, wrong))
    end = linked.end_of(2)
    assert not end.accepted
    assert "line 2" in end.message
    linked.do(Play(3, BOTH, tmp_path / "none.csv"))
    assert linked.end_of(3).slots == {"file": str(tmp_path / "none.csv")}


# -- a suspended node -----------------------------------------------------------------------------
