"""The Mega and the virtual board make the same steps in the same milliseconds."""

from __future__ import annotations

import random

import numpy as np
import pytest
from avr.bench import CYCLES_PER_MS, TICK
from avr.mega import Mega
from firmware_host import SPEED_MAX, Rig, Steps
from numpy.typing import NDArray

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import FrameType, Move, MoveStraight

IN_TICK = 550
"""Cycles from the time a tick is due to the end of a frame: the tick still runs, and the main loop handles the frame
right after it."""
AHEAD_MS = 2
"""Milliseconds from the time a tick is due to the end of the millisecond that it plans."""
STOP_MS = 660
MORE = pytest.mark.long("a search with random sequences")
LENGTH_MS = 1200
"""Milliseconds until all arms rest: a stop from full speed takes half a second."""


def script(seed: int) -> dict[int, bytes]:
    """Return random frames by the millisecond in which the board handles them: moves, stops, and a final STOP."""
    chance = random.Random(seed)
    frames, ms = {}, 5
    while ms < STOP_MS - 40:
        around = chance.randint(-300, 300)
        target = (around, around + chance.randint(-200, 200), around + chance.randint(-200, 200))
        speed = (SPEED_MAX, chance.randint(500, SPEED_MAX), chance.randint(500, SPEED_MAX))
        straight = chance.randint(0, 1)
        wanted = MoveStraight(ms, target, speed[0]) if straight else Move(ms, target, speed)
        move = encode(wanted.kind, 1, wanted.pack())
        frames[ms] = chance.choice([move, move, move, encode(FrameType.STOP, 2, b"")])
        ms += chance.choice([chance.randint(5, 40), chance.randint(40, 300)])
    frames[STOP_MS] = encode(FrameType.STOP, 3, b"")
    return frames


def last_tick(mega: Mega) -> int:
    """Return the cycle at which the last tick was due; its interrupt may have started later."""
    late = []
    for _ in range(20):
        mega.avr.run(CYCLES_PER_MS)
        late.append(mega.avr.work(TICK).last % CYCLES_PER_MS)
    return mega.avr.work(TICK).last - late[-1] + min(late)


def positions(mega: Mega, arm: int, times: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the position of an arm at these cycles, counted on its pins."""
    steps, directions = mega.avr.steps(arm)
    counts: NDArray[np.int64] = np.concatenate([[0], np.cumsum(directions)])
    return counts[np.searchsorted(steps, times)]


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(n, marks=MORE) for n in range(2, 50))])
def test_mega_and_virtual_board_differ_by_at_most_a_step(seed: int, mega: Mega) -> None:
    frames = script(seed)
    firmware = Firmware()
    Rig(firmware).ready()
    planned: list[Steps] = []
    begin = last_tick(mega)
    for ms in range(1, LENGTH_MS):
        firmware.tick(1)
        planned.append(firmware.steps())
        if ms in frames:
            firmware.receive(frames[ms])
            due = begin + ms * CYCLES_PER_MS + IN_TICK
            mega.avr.run_until(due - len(frames[ms]) * mega.avr.byte_cycles)
            mega.avr.deliver(frames[ms])
    mega.avr.run_until(begin + (LENGTH_MS + AHEAD_MS) * CYCLES_PER_MS)
    mega.tick(0)
    assert (mega.avr.work(TICK).last - begin) % CYCLES_PER_MS < 1000  # no tick was late by a millisecond
    times = begin + (np.arange(1, LENGTH_MS) + AHEAD_MS) * CYCLES_PER_MS
    for arm in range(3):
        apart = np.array([steps[arm] for steps in planned]) - positions(mega, arm, times)
        assert np.abs(apart).max() <= 1
    assert planned[-1] == mega.steps == mega.last.position
