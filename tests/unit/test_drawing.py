"""The drawing of a robot's model agrees with its kinematics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.recording import drawing
from beatrix_zenoh.recording.drawing import Array, Pixels, PoseRenderer
from beatrix_zenoh.recording.figure import Body, Figure, ellipsoid

SIZE = 320, 240
MARK = (250, 10, 240)
"""A colour that the robot does not have."""


class Marked(Figure):
    """The robot with a ball of this radius (m) in front of its face."""

    def __init__(self, place: tuple[float, float, float], radius: float = 0.01) -> None:
        super().__init__()
        self.bodies = tuple(
            Body(body.path, (*body.solids, ellipsoid(place, (radius,) * 3, MARK)))
            if body.path == "head"
            else body
            for body in self.bodies
        )


def arms(*head: float) -> Array:
    """Return the angles of the arms (deg) that turn the head to yaw, pitch and roll (deg)."""
    return np.degrees(Neck().inverse(*(math.radians(angle) for angle in head)))


def where(picture: Pixels, colour: tuple[int, int, int]) -> tuple[float, float]:
    """Return column and row of the middle of the pixels with the hue of a colour."""
    part = picture.astype(float) / np.maximum(picture.max(axis=2, keepdims=True), 1)
    rows, columns = np.nonzero(np.abs(part - np.array(colour) / max(colour)).max(axis=2) < 0.08)
    assert len(rows), f"nothing is {colour}"
    return float(columns.mean()), float(rows.mean())


@pytest.mark.parametrize("head", [(0, 0, 0), (30, 10, 5), (-60, -15, -10), (20, 30, 0)])
def test_a_mark_on_the_head_is_where_the_orientation_puts_it(head: tuple[float, float, float]) -> None:
    place = (0.14, 0.0, 0.1)
    picture = PoseRenderer(Marked(place), *SIZE).picture(arms(*head), np.array(head, float))
    x, y, _ = drawing.camera() @ (
        np.array(rotation_of(*np.radians(head))) @ place - np.array((0, 0, drawing.CENTRE_HEIGHT_M))
    )
    scale = SIZE[1] / drawing.VISIBLE_M
    column, row = where(picture, MARK)
    assert column == pytest.approx(SIZE[0] / 2 + x * scale - 0.5, abs=1.0)
    assert row == pytest.approx(SIZE[1] / 2 - y * scale - 0.5, abs=1.0)


def test_a_mark_behind_the_head_is_hidden() -> None:
    x, y, z = -0.13 * drawing.camera()[2]
    figure = Marked((x, y, z + 0.11))
    picture = PoseRenderer(figure, *SIZE).picture(arms(0, 0, 0), np.zeros(3))
    with pytest.raises(AssertionError, match="nothing is"):
        where(picture, MARK)
    turned = PoseRenderer(figure, *SIZE).picture(arms(150, 0, 0), np.array((150.0, 0, 0)))
    where(turned, MARK)


def test_a_pose_is_drawn_again_only_if_it_changes() -> None:
    made = PoseRenderer(Figure(), *SIZE)
    first = made.picture(arms(0, 0, 0), np.zeros(3))
    assert made.picture(arms(0, 0, 0), np.full(3, 0.01)) is first
    assert made.picture(arms(1, 0, 0), np.array((1.0, 0, 0))) is not first
