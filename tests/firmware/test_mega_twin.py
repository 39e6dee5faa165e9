"""The Mega and the virtual board are one firmware: the same steps at the same millisecond."""

from __future__ import annotations

import random

import numpy as np
import pytest
from avr.bench import CYCLES_PER_MS, TICK
from avr.mega import Mega
from numpy.typing import NDArray
from rig import SPEED_MAX, Rig, Steps

from beatrix_zenoh._generated.serial import FrameType, Move
from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware

IN_TICK = 200
"""Cycles after a tick was due: it is running, and a frame that comes now is the first thing dealt with after it."""
AHEAD_MS = 2
"""A tick plans the millisecond that begins one millisecond after it was due."""
STOP_MS = 660
LENGTH_MS = 1200
"""All arms have rested for a while: a stop from full speed takes half a second."""


def script(seed: int) -> dict[int, bytes]:
    """Frames by the millisecond in which they come: moves (numbered by it), retargets, stops, and STOP in the end."""
    chance = random.Random(seed)
    frames, ms = {}, 5
    while ms < STOP_MS - 40:
        around = chance.randint(-300, 300)
        target = (around, around + chance.randint(-200, 200), around + chance.randint(-200, 200))
        speed = (SPEED_MAX, chance.randint(500, SPEED_MAX), chance.randint(500, SPEED_MAX))
        move = encode(FrameType.MOVE, 1, Move(chance.randint(0, 1), ms, target, speed).pack())
        frames[ms] = chance.choice([move, move, move, encode(FrameType.STOP, 2, b"")]) if ms > 5 else move
        ms += chance.choice([chance.randint(5, 40), chance.randint(40, 300)])
    frames[STOP_MS] = encode(FrameType.STOP, 3, b"")
    return frames


def last_tick(mega: Mega) -> int:
    """The cycle at which the last tick was due; its interrupt may have come later."""
    late = []
    for _ in range(20):
        mega.avr.run(CYCLES_PER_MS)
        late.append(mega.avr.work(TICK).last % CYCLES_PER_MS)
    return mega.avr.work(TICK).last - late[-1] + min(late)


def positions(mega: Mega, arm: int, times: NDArray[np.int64]) -> NDArray[np.int64]:
    """Steps on an arm's pins up to these cycles."""
    steps, directions = mega.avr.steps(arm)
    counts: NDArray[np.int64] = np.concatenate([[0], np.cumsum(directions)])
    return counts[np.searchsorted(steps, times)]


def live(mega: Mega, frames: dict[int, bytes], begin: int) -> dict[int, int]:
    """Let the Mega live through the script; by each frame's millisecond that in which it was dealt with.

    A motion's first telemetry is sent right after it has begun, and names the tick before.
    """
    for ms, frame in frames.items():
        mega.avr.run_until(begin + ms * CYCLES_PER_MS + IN_TICK - len(frame) * mega.avr.byte_cycles)
        mega.avr.deliver(frame)
    mega.avr.run_until(begin + (LENGTH_MS + AHEAD_MS) * CYCLES_PER_MS)
    mega.tick(0)
    began = {t.motion: t.tick for t in reversed(mega.telemetry)}
    first = min(frames)
    return {ms: began[ms] - began[first] + first if ms in began else ms for ms in frames}


@pytest.mark.parametrize("seed", range(50))
def test_mega_and_virtual_board_are_never_more_than_a_step_apart(seed: int) -> None:
    frames = script(seed)
    with Mega() as mega:
        mega.ready()
        begin = last_tick(mega)
        done = live(mega, frames, begin)
        assert all(0 <= then - ms <= 1 for ms, then in done.items())
        assert (mega.avr.work(TICK).last - begin) % CYCLES_PER_MS < 1000  # no tick was late by a millisecond
        firmware = Firmware()
        Rig(firmware).ready()
        due = {then: frames[ms] for ms, then in done.items()}
        planned: list[Steps] = []
        for ms in range(1, LENGTH_MS):
            firmware.tick(1)
            planned.append(firmware.steps())
            if ms in due:
                firmware.receive(due[ms])
        times = begin + (np.arange(1, LENGTH_MS) + AHEAD_MS) * CYCLES_PER_MS
        for arm in range(3):
            apart = np.array([steps[arm] for steps in planned]) - positions(mega, arm, times)
            assert np.abs(apart).max() <= 1
        assert planned[-1] == mega.steps == mega.last.position
