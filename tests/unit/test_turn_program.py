"""The program that turns to a sound: where both ears of the simulated room hear it."""

from __future__ import annotations

import math
import runpy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.node.sensors import BLOCK, RATE
from sim_node.hearing import Ears, PlayingSound, generated, hearing

EXAMPLES = Path(__file__).resolve().parents[2] / "beatrix_zenoh/examples"


@cache
def program() -> dict[str, Any]:
    """Return the names of the program, which starts nothing when it is imported."""
    return runpy.run_path(str(EXAMPLES / "turn_to_the_sound.py"))


@pytest.mark.parametrize("sound", ["voice", "noise"])
@pytest.mark.parametrize("bearing", [-75, -40, -5, 0, 20, 60])
def test_a_sound_is_heard_where_it_comes_from(sound: str, bearing: float) -> None:
    way, ears = math.radians(bearing), Ears(seed=1)
    heard = hearing(rotation_of(0, 0, 0), (0, 0, 0), (1.15 * math.cos(way), 1.15 * math.sin(way), 0.08))
    playing = PlayingSound(sound, 0.0, 60.0, generated(sound))
    blocks = [ears.block(heard, playing, 0.6 + number * BLOCK / RATE) for number in range(20)]
    left, right = np.concatenate(blocks).T
    assert program()["direction"](left, right, RATE) == pytest.approx(bearing, abs=2.0)
