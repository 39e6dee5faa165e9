"""The shape of the head: skull, visor, eyes with lids, brows, mouth, ears, and the posts to the neck."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from beatrix_zenoh.body.surface import Modeller
from beatrix_zenoh.contract._generated.robot import COLOURS, SIZES, HeadData
from beatrix_zenoh.motion.rotation import Vector

BALL: Final = 0.0215
"""Radius (m) of an eye."""
OUT: Final = (0.0, 1.0, 0.0)


class Face(NamedTuple):
    """Lids and gaze: those of the robot are fixed, as AWAKE is; only a picture of a sleeping robot has others."""

    lid: float = 0.0
    """0: open, 1: closed"""
    left: float = 0.0
    up: float = 0.0
    """gaze, -1 to 1; 0: straight ahead, as the cameras"""


AWAKE: Final = Face()


def add_head(model: Modeller, size: HeadData, mounts: Sequence[Vector], face: Face) -> None:
    """Add the head; `mounts` are unit vectors from the neck centre to the hinges of the rods."""
    height, top = size.centre_height, (0.0, 0.0, 0.040)
    visor = (0.054, 0.0, height + SIZES.eye_up)
    model.ellipsoid("head", (0.0, 0.0, height + 0.003), (0.083, 0.078, 0.091), COLOURS.shell, 0.8)
    model.cylinder("head", (0.0, 0.0, 0.044), (0.0, 0.0, 1.0), (0.030, 0.012), COLOURS.trim)
    for x, y, z in mounts:
        ends = 0.044, size.mount_radius * 1.08
        model.tube("head", [(x * end, y * end, z * end) for end in ends], 0.0032, COLOURS.metal)
        post = [(x * 0.046, y * 0.046, z * 0.046), (x * 0.040, y * 0.040, z * 0.040 + 0.012), top]
        model.tube("head", post, 0.0065, COLOURS.trim)
    sides = 1.0, -1.0
    for side in sides:
        _ear(model, (-0.006, side * 0.073, height + 0.012))
    model.ellipsoid("head", visor, (0.036, 0.063, 0.033), COLOURS.visor, 0.6)
    smile = [
        (0.0735 - 4.0 * y * y, y, height - 0.056 + 9.0 * y * y) for y in (k * 0.006 for k in range(-4, 5))
    ]
    model.tube("head", smile, 0.0026, COLOURS.visor)
    for side in sides:
        _brow_and_cheek(model, height, side)
    for side in sides:
        _eye(model, (0.081, side * size.eye_baseline / 2, height + SIZES.eye_up), face)


def _ear(model: Modeller, ear: Vector) -> None:
    model.cylinder("head", ear, OUT, (0.023, 0.012), COLOURS.trim)
    model.cylinder("head", ear, OUT, (0.016, 0.016), COLOURS.rod)
    model.cylinder("head", ear, OUT, (0.007, 0.019), COLOURS.trim)


def _brow_and_cheek(model: Modeller, height: float, side: float) -> None:
    brow = [
        (0.0755 - 7.6 * y * y, side * y, height + 0.064 - 26.0 * (y - 0.033) ** 2)
        for y in (0.018 + 0.005 * k for k in range(7))
    ]
    model.tube("head", brow, 0.0032, COLOURS.visor)
    model.ellipsoid("head", (0.068, side * 0.046, height - 0.032), (0.004, 0.011, 0.008), COLOURS.cheek)


def _eye(model: Modeller, eye: Vector, face: Face) -> None:
    """Add ball, iris, pupil and upper lid of an eye; without iris if it is closed."""
    x, y, z = eye
    model.ellipsoid("head", eye, (BALL, BALL, BALL), COLOURS.white)
    if face.lid < 1:
        y, z = y + 0.009 * face.left, z + 0.008 * face.up
        x -= 0.003 * (face.left**2 + face.up**2)
        model.ellipsoid("head", (x + 0.0178, y, z), (0.006, 0.0135, 0.0135), COLOURS.iris)
        model.ellipsoid("head", (x + 0.0215, y, z), (0.004, 0.0075, 0.0075), COLOURS.black)
        model.ellipsoid("head", (x + 0.0232, y + 0.004, z + 0.0045), (0.0024, 0.0024, 0.0024), COLOURS.white)
    if face.lid:
        x, y, z = eye
        lid = x - 0.010 * (1 - face.lid), y, z + 0.026 * (1 - face.lid)
        model.ellipsoid("head", lid, (BALL + 0.0065, BALL + 0.002, BALL + 0.001), COLOURS.shell)
    if face.lid == 1:
        edge = [
            (x + 0.0295 - 30 * v * v, y + v, z - 0.006 + 18 * v * v)
            for v in (k * 0.0045 for k in range(-3, 4))
        ]
        model.tube("head", edge, 0.0018, COLOURS.visor)
