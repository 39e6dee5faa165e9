"""The link of the window: programs of blocks on simulations and virtual boards."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from block_programs import block, lesson_1, repeat, saved
from gui_links import Linked, rests, short
from late_tests import in_time
from robots import Stage

from beatrix_zenoh.contract._generated.messages import Limit, Reason
from beatrix_zenoh.lessons.measures import swings
from gui.console.state.actions import EndBlocks, RunBlocks, Send, SendStop
from gui.console.state.intents import Choose
from gui.console.state.state import State

SIM, BOTH = ("sim",), ("sim", "hw")
SWAY = saved(block("forever", DO=[block("turn", ANGLE=40), block("turn", ANGLE=-40)]))
"""A program without an end."""


def test_lesson_1_as_blocks_moves_the_head_and_names_the_refused_block(linked: Linked, stage: Stage) -> None:
    with stage.robot("bea", "sim", "eve").log() as log:
        linked.do(RunBlocks(1, SIM, lesson_1()))
        end = linked.end_of(1, "sim")
    assert (end.reason, end.block) == (Reason.OUT_OF_REACH, "too-far")
    assert end.detail is not None
    head = np.array(log.head)
    assert sum(size >= 10 for size in swings(head[:, 1], least=2)) >= 4
    yaw = swings(head[:, 0], least=2)
    assert (head[:, 0].max() > 20, head[:, 0].min() < -20, sum(size >= 40 for size in yaw)) == (True, True, 3)
    assert short(linked.world, "sim") == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("sides", [SIM, BOTH])
def test_a_program_without_an_end_ends_by_stop_and_the_arms_rest(
    linked: Linked, sides: tuple[str, ...]
) -> None:
    linked.do(RunBlocks(1, sides, SWAY))
    linked.until(lambda world: all(abs(short(world, side)) > 1 for side in sides), "it moves")
    assert (linked.world.blocks_run, linked.world.block) == (True, "turn-id")
    began_s = time.monotonic()
    linked.do(SendStop(2))
    world = linked.until(
        lambda world: all(rests(world, side) for side in sides) and not world.blocks_run, "rest"
    )
    in_time(time.monotonic() - began_s, 0.9, "STOP of a program of blocks")
    assert (world.block, linked.end_of(1, "" if sides == BOTH else "sim").reason) == ("", Reason.STOPPED)
