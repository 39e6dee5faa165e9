"""The link of the window: programs of blocks on simulations and virtual boards."""

from __future__ import annotations

import time

import pytest
from block_programs import block, lesson_1, repeat, saved
from gui_links import Linked, look, rests, short
from late_tests import in_time
from robots import Stage

from beatrix_zenoh.contract._generated.messages import Limit, Reason
from beatrix_zenoh.lessons.measures import swings
from gui.console.state.actions import Action, EndBlocks, RunBlocks, Send, SendStop

SIM, BOTH = ("sim",), ("sim", "hw")
SWAY = saved(block("forever", DO=[block("turn", ANGLE=40), block("turn", ANGLE=-40)]))
"""A program without an end."""


@pytest.mark.long("plays in real time")
def test_lesson_1_as_blocks_moves_the_head_and_names_the_refused_block(linked: Linked, stage: Stage) -> None:
    with stage.robot("bea", "sim", "eve").log() as log:
        linked.do(RunBlocks(1, SIM, lesson_1()))
        end = linked.end_of(1, "sim")
    assert end.block == "too-far"
    assert end.detail is not None
    assert end.detail.limit is Limit.TILT
    assert sum(size >= 10 for size in swings(log.pitch, least=2)) >= 4
    assert sum(size >= 40 for size in swings(log.yaw, least=2)) == 3
    assert log.yaw.max() > 20
    assert log.yaw.min() < -20
    assert short(linked.world, "sim") == pytest.approx(0, abs=0.1)


def test_blocks_of_each_kind_move_both_robots_with_the_lead(linked: Linked) -> None:
    turned = block("logic_compare", {"OP": "GT"}, A=block("position", {"PART": "short"}), B=8)
    then = block("controls_if", IF0=turned, DO0=[block("turn", ANGLE=12)], ELSE=[block("turn", ANGLE=30)])
    speed = block("speed", SPEED=50)
    arm = block("arm", {"ARM": "short"}, ANGLE=9)
    linked.do(
        RunBlocks(
            1, BOTH, saved(speed, arm, then, block("gesture", {"NAME": "no"}), block("nod", ANGLE=3)), 0.3
        )
    )
    world = linked.until(lambda world: abs(short(world, "sim")) > 1, "the simulation moves")
    assert abs(short(world, "hw")) < 1
    linked.until(lambda world: short(world, "hw") == pytest.approx(12, abs=0.1), "the hardware has turned")
    linked.until(lambda world: world.block == "gesture-id", "the gesture begins")
    assert linked.end_of(1).accepted
    assert linked.world.block is None


@pytest.mark.measures_time
@pytest.mark.parametrize("sides", [SIM, BOTH])
@pytest.mark.parametrize("by", [SendStop(2), EndBlocks()])
def test_a_program_without_an_end_is_ended_and_the_arms_rest(
    linked: Linked, by: Action, sides: tuple[str, ...]
) -> None:
    linked.do(RunBlocks(1, sides, SWAY))
    linked.until(lambda world: all(abs(short(world, side)) > 1 for side in sides), "it moves")
    assert linked.world.block == "turn-id"
    began_s = time.monotonic()
    linked.do(by)
    world = linked.until(
        lambda world: world.block is None and all(rests(world, side) for side in sides), "it rests"
    )
    in_time(time.monotonic() - began_s, 0.9, "the end of a program of blocks")
    assert world.block is None
    assert linked.end_of(1, "sim" if sides == SIM else "").reason is Reason.STOPPED


@pytest.mark.measures_time
@pytest.mark.parametrize("inner", [[], [block("wait", SECONDS=600)]])
def test_a_program_that_only_waits_ends_at_once_by_stop_of_another_seat(
    linked: Linked, stage: Stage, inner: list[dict[str, object]]
) -> None:
    linked.do(RunBlocks(1, SIM, saved(block("forever", DO=inner))))
    linked.accepted(1, "sim")
    began_s = time.monotonic()
    stage.robot("bea", "sim", "eve").stop()
    end = linked.end_of(1, "sim")
    in_time(time.monotonic() - began_s, 0.9, "STOP of another seat")
    assert (end.reason, end.message) == (Reason.STOPPED, "bea (sim): eve pressed STOP.")


def test_a_newer_motion_replaces_a_program(linked: Linked) -> None:
    linked.do(RunBlocks(1, SIM, SWAY))
    linked.until(lambda world: abs(short(world, "sim")) > 1, "it moves")
    linked.do(RunBlocks(2, SIM, saved(repeat(2, block("wait", SECONDS=0.1)), block("wait_stop"))))
    linked.accepted(2, "sim")
    assert linked.end_of(1, "sim").reason is Reason.REPLACED
    linked.do(Send(3, look(5), SIM))
    assert linked.end_of(3, "sim").accepted
    assert linked.end_of(2, "sim").reason is Reason.REPLACED


def test_a_program_is_refused_at_the_robot_of_another_seat(linked: Linked, stage: Stage) -> None:
    with stage.robot("bea", "sim", "eve").lease(wait_s=10):
        linked.do(RunBlocks(1, SIM, saved(block("wait", SECONDS=1), block("turn", ANGLE=9))))
        end = linked.end_of(1, "sim")
        assert (end.reason, end.block) == (Reason.NOT_HOLDER, "")
        assert not linked.of(1, "sim")[0].accepted
    linked.do(RunBlocks(2, SIM, SWAY))
    linked.until(lambda world: abs(short(world, "sim")) > 1, "it moves")
    with stage.robot("bea", "sim", "teacher").lease():
        assert linked.end_of(2, "sim").message.startswith("Ended by the teacher")
        linked.until(lambda world: rests(world, "sim"), "it rests")


def test_a_program_that_cannot_go_on_names_the_block(linked: Linked) -> None:
    broken = block("wait", SECONDS=block("math_arithmetic", {"OP": "DIVIDE"}, A=1, B=0))
    linked.do(RunBlocks(1, SIM, saved(block("turn", ANGLE=3), broken)))
    end = linked.end_of(1, "sim")
    assert (end.key, end.block) == ("blocks.zero", "math_arithmetic-id")
    linked.do(RunBlocks(2, SIM, "{"))
    assert linked.end_of(2, "sim").key == "blocks.format"
