"""The drawing of a robot's model agrees with its kinematics."""

from __future__ import annotations

import numpy as np
import pytest

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.portrait import SMOOTHING, VIEW, Pixels, painted
from beatrix_zenoh.body.scene import Screen, draw
from beatrix_zenoh.body.surface import Mesh, Modeller
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import rotation_of

SIZE = 640, 480
ROBOT, SCREEN = Figure(), Screen(VIEW, *SIZE)
MARK = (250, 10, 240)
"""A colour that the robot does not have."""


def marked(place: tuple[float, float, float]) -> tuple[Mesh, ...]:
    """Return the robot with a ball of a radius of 1 cm in front of its face."""
    model = Modeller(fine=False)
    model.ellipsoid("head", place, (0.01, 0.01, 0.01), MARK)
    return (*meshes(ROBOT), *model.meshes())


def picture(shapes: tuple[Mesh, ...], *head: float) -> Pixels:
    """Return the picture of a robot whose head is turned to yaw, pitch and roll (deg)."""
    angles = np.radians(head)
    turns = ROBOT.orientations(Neck().inverse(*angles), rotation_of(*angles))
    return painted(draw(shapes, turns, SCREEN), SCREEN)


def where(picture: Pixels, colour: tuple[int, int, int]) -> tuple[float, float]:
    """Return column and row of the middle of the pixels with the hue of a colour."""
    part = picture.astype(float) / np.maximum(picture.max(axis=2, keepdims=True), 1)
    rows, columns = np.nonzero(np.abs(part - np.array(colour) / max(colour)).max(axis=2) < 0.08)
    assert len(rows), f"nothing is {colour}"
    return float(columns.mean()), float(rows.mean())


@pytest.mark.parametrize("head", [(0, 0, 0), (30, 10, 5), (-60, -15, -10), (20, 30, 0)])
def test_a_mark_on_the_head_is_where_the_orientation_puts_it(head: tuple[float, float, float]) -> None:
    place = (0.14, 0.0, 0.1)
    shown = SCREEN.place(np.array(rotation_of(*np.radians(head)))[None] @ place)[0]
    assert where(picture(marked(place), *head), MARK) == pytest.approx(shown[:2] / SMOOTHING - 0.5, abs=1.0)
