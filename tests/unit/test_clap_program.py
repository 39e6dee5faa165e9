"""The program that nods at a clap: what it takes for a clap."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.node.sensors import BLOCK, RATE
from sim_node.hearing import Ears, PlayingSound, generated, hearing

PROGRAM = Path(__file__).resolve().parents[2] / "beatrix_zenoh/examples/nod_at_a_clap.py"


@pytest.mark.parametrize(
    ("sound", "moving", "count"),
    [("clap", False, 3), ("voice", False, 0), ("noise", False, 0), ("clap", True, 0)],
)
def test_only_claps_are_claps(sound: str, moving: bool, count: int) -> None:
    """The room claps once a second, from 0.5 s on; `moving`: only the motors are heard."""
    ears, blocks = Ears(seed=1), []
    for number in range(round(3.4 * RATE / BLOCK)):
        arms = (0.01 * number, 0.0, 0.0) if moving else (0.0, 0.0, 0.0)
        heard = hearing(rotation_of(0, 0, 0), arms, (1.0, 0.5, 0.08))
        playing = None if moving else PlayingSound(sound, 0.5, 60.0, generated(sound))
        blocks.append(ears.block(heard, playing, number * BLOCK / RATE))
    found = runpy.run_path(str(PROGRAM))["claps"](np.concatenate(blocks), RATE)
    assert found == pytest.approx([0.51, 1.51, 2.51][:count], abs=0.03)
