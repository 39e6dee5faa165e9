"""Triangle meshes as arrays."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]
Point = tuple[float, float, float]
"""x forward, y left, z up (m), from the neck centre."""


class Shape(NamedTuple):
    """A closed triangle mesh."""

    vertices: Vector
    """shape (n, 3), in m"""
    faces: npt.NDArray[np.int32]
    """shape (m, 3), counter-clockwise from outside"""


def skin(rings: Vector) -> Shape:
    """Return a closed hull through rings of points, shape (rings, points, 3), counter-clockwise seen from the last."""
    count, around, _ = rings.shape
    vertices = np.concatenate((rings.reshape(-1, 3), [rings[0].mean(axis=0)], [rings[-1].mean(axis=0)]))
    faces = []
    for i in range(around):
        j = (i + 1) % around
        for low in range(0, (count - 1) * around, around):
            high = low + around
            faces += [(low + i, low + j, high + j), (low + i, high + j, high + i)]
        last = (count - 1) * around
        faces += [(count * around, j, i), (count * around + 1, last + i, last + j)]
    return Shape(vertices, np.array(faces, dtype=np.int32))


def twisted_rod(start: Vector, end: Vector, radius: float, width: float, thickness: float) -> Shape:
    """Return a flat bar along the great circle from direction `start` to `end`, twisted by 90 deg; lengths in m."""
    angle = math.acos(float(np.clip(start @ end, -1.0, 1.0)))
    side = np.cross(start, end) / math.sin(angle)
    rings = []
    for part in np.linspace(0.0, 1.0, 25):
        out = (math.sin((1 - part) * angle) * start + math.sin(part * angle) * end) / math.sin(angle)
        twist = part * math.pi / 2
        wide = math.cos(twist) * side + math.sin(twist) * out
        thin = np.cross(np.cross(side, out), wide)
        corners = _rounded_rectangle(width, thickness)
        rings.append(out * radius + corners[:, :1] * wide + corners[:, 1:] * thin)
    return skin(np.array(rings))


def internal_gear(outer: float, pitch: float, height: float, teeth: int) -> Shape:
    """Return a ring with teeth on its inside, centred in its frame; radii and height in m."""
    points = 4 * teeth
    azimuth = np.linspace(0.0, math.tau, points, endpoint=False)
    depth = pitch * 2.0 / teeth
    inner = pitch + depth * np.tile((1.0, 1.0, -1.0, -1.0), teeth)
    loops = []
    for radius, z in ((np.full(points, outer), -1), (np.full(points, outer), 1), (inner, 1), (inner, -1)):
        loops.append(
            np.column_stack(
                (radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(points, z * height / 2))
            )
        )
    faces = []
    for i in range(points):
        j = (i + 1) % points
        for loop in range(4):
            low, high = loop * points, (loop + 1) % 4 * points
            faces += [(low + i, low + j, high + j), (low + i, high + j, high + i)]
    return Shape(np.concatenate(loops), np.array(faces, dtype=np.int32))


def _rounded_rectangle(width: float, thickness: float) -> Vector:
    angle = np.linspace(0.0, math.tau, 16, endpoint=False)
    return np.column_stack(
        (_powers(np.cos(angle), 0.4) * width / 2, _powers(np.sin(angle), 0.4) * thickness / 2)
    )


def _powers(values: Vector, exponent: float) -> Vector:
    powers: Vector = np.sign(values) * np.abs(values) ** exponent
    return powers
