"""Pictures of a recording, drawn without a screen and checked by their pixels."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from viewer_pictures import pictures
from written_recordings import BEGAN_NS, write_lesson

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.recording.rows import BodyTurn, Numbers, RecordingRow, of_model, of_robot
from beatrix_zenoh.recording.rrd.scene import BACKGROUND

SIM, HW = ("bea", "sim"), ("bea", "hw")


def rows(place: tuple[str, str], yaw: float) -> list[RecordingRow]:
    """Return rows of a robot whose head is turned by `yaw` (rad)."""
    arms = Neck().inverse(yaw, 0.0, 0.0)
    turns = Figure().rotations(arms, rotation_of(yaw, 0.0, 0.0))
    poses: list[RecordingRow] = [
        BodyTurn(of_model(place, path), BEGAN_NS, BEGAN_NS, turn) for path, turn in turns.items()
    ]
    numbers = (math.degrees(yaw),) * 3
    return [*poses, Numbers(of_robot(place, "arms"), BEGAN_NS, BEGAN_NS, numbers)]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A recording of two robots, of which the simulation has turned."""
    path = tmp_path / "lesson.rrd"
    write_lesson(path, [SIM, HW], 0, [*rows(SIM, 0.8), *rows(HW, 0.0)])
    return path


@pytest.mark.long("a renderer without a graphics card")
def test_the_ghost_is_visible_beside_the_hardware_and_both_robots_side_by_side(path: Path) -> None:
    overlay, beside = (
        np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=np.int64)
        for png in pictures(path, [(0, BEGAN_NS / 1e9), (1, BEGAN_NS / 1e9)])
    )
    assert np.mean(background(overlay)) > 0.5
    assert share_of_blue(overlay) > 0.005  # without the ghost, the long arm alone has 0.003
    left, right = np.array_split(beside, 2, axis=1)
    for half in (left, right):
        assert 0.01 < np.mean(~background(half[150:])) < 0.5, "one robot; titles are above"
        assert 0.001 < share_of_blue(half) < 0.008, "its long arm, and no ghost"
    assert np.mean(background(left) != background(right)) > 0.005, "the simulation has turned"


Picture = np.ndarray[tuple[int, ...], np.dtype[np.int64]]


def background(picture: Picture) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return which pixels show no robot."""
    return np.all(np.abs(picture - BACKGROUND) < 6, axis=2)  # type: ignore[no-any-return]


def share_of_blue(picture: Picture) -> float:
    """Return the share of blue pixels: the long arm and the ghost."""
    red, green, blue = np.moveaxis(picture, 2, 0)
    return float(np.mean((blue > red + 60) & (blue > green + 20)))
