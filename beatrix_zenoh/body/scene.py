"""Drawing the robot without a graphics card: camera, light, and the order in which faces are painted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.surface import Floats, Mesh
from beatrix_zenoh.contract._generated.robot import ROBOT

LOOKED_AT: Final = 0.055
"""Height (m, from the neck centre) of the middle of the picture."""
HALF_HEIGHT: Final = 0.20
"""Half of the height (m) that the picture shows in the middle, at zoom 1."""
AWAY: Final = 1.1
"""Distance of the camera from the middle of the picture (m)."""
LIGHT: Final = (-0.45, 0.75, 0.6)
"""Direction to the light in the camera's frame: right, up, towards the viewer."""
DARKEST: Final = 0.42
"""Brightness of a face that is turned away from the light."""
SHADES: Final = 24
"""Number of steps from black to the full colour."""
OVERLAP_PX: Final = 0.7
"""By how much each face is enlarged, so that no ground shows between neighbours."""
LIFT: Final = 0.010, 0.040
"""By how much (m) the parts on the skull count as nearer when faces are sorted: all of them, and the last ones more."""
HULL: Final = 60
"""Number of directions of an outline."""
SKULL: Final = (0.0, 0.0, ROBOT.head.centre_height)
NOSE: Final = (0.102, 0.0, ROBOT.head.centre_height - 0.022)
EARS: Final = {
    "left": (-0.006, 0.082, ROBOT.head.centre_height + 0.012),
    "right": (-0.006, -0.082, ROBOT.head.centre_height + 0.012),
}
CROWN: Final = (0.0, 0.0, ROBOT.head.centre_height + 0.102)
"""Points of the head at home (m, from the neck centre)."""
Whole = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Viewpoint:
    """Where the viewer is: angles in deg."""

    azimuth: float = 180.0
    """0 is in front of the robot, 90 at its left"""
    elevation: float = 12.0
    """above the horizontal"""
    zoom: float = 1.0
    height: float = LOOKED_AT
    """of the middle of the picture (m, from the neck centre)"""

    @property
    def middle(self) -> Floats:
        """The point in the middle of the picture (m)."""
        return np.array((0.0, 0.0, self.height))

    @cached_property
    def axes(self) -> Floats:
        """Rows: right, up, and towards the viewer, in the robot's frame."""
        a, e = math.radians(self.azimuth), math.radians(self.elevation)
        ca, sa, ce, se = math.cos(a), math.sin(a), math.cos(e), math.sin(e)
        return np.array(((-sa, ca, 0.0), (-se * ca, -se * sa, ce), (ce * ca, ce * sa, se)))


@dataclass(frozen=True)
class Screen:
    """A camera, and the picture that it fills (px)."""

    camera: Viewpoint
    width: float
    height: float
    aside: float = 0.0
    """how far to the right of the middle the head is (px)"""

    @property
    def scale(self) -> float:
        """Pixels for a metre in the middle of the picture."""
        return min(self.height, self.width * 1.1) / (2 * HALF_HEIGHT) * self.camera.zoom

    def place(self, points: Floats) -> Floats:
        """Return where points, (n, 3) in the robot's frame, are on the picture.

        Returns:
            (n, 3): x to the right and y down (px), and the nearness to the viewer (m), 0 in the middle.
        """
        seen = _turned(points - self.camera.middle, self.camera.axes)
        size = self.scale * AWAY / np.maximum(AWAY - seen[:, 2], 0.05)
        x = self.width / 2 + self.aside + seen[:, 0] * size
        y = self.height / 2 - seen[:, 1] * size
        return np.column_stack((x, y, seen[:, 2]))


@dataclass(frozen=True)
class HeadDrawing:
    """The visible faces of one robot, the furthest first."""

    corners: Floats
    """(m, 4, 2), px"""
    colours: Whole
    """(m), 0xRRGGBB"""


class _Faces(NamedTuple):
    """What `draw` needs of each face of a mesh."""

    corners: Floats
    """(m, 4, 3), in m"""
    centres: Floats
    normals: Floats
    lifts: Floats
    """(m), in m: see LIFT"""
    colours: npt.NDArray[np.uint8]


@cache
def _faces(mesh: Mesh) -> _Faces:
    corners = mesh.points[mesh.faces]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    order = mesh.order[mesh.faces[:, 0]]
    lifts = np.where((order > 0) & (mesh.body == "head"), LIFT[0] + LIFT[1] * order**2, 0.0)
    return _Faces(corners, corners.mean(axis=1), normals, lifts, mesh.colours[mesh.faces[:, 0]])


def draw(meshes: tuple[Mesh, ...], turns: dict[str, Floats], screen: Screen) -> HeadDrawing:
    """Return the faces that are turned to the viewer, shaded.

    Args:
        meshes: the robot.
        turns: rotation of each body, as from `Figure.orientations`.
        screen: camera and size of the picture.
    """
    axes = screen.camera.axes
    light = np.array(LIGHT) / np.linalg.norm(LIGHT) @ axes
    viewer = screen.camera.middle + axes[2] * AWAY
    found, depths, colours = [], [], []
    for mesh in meshes:
        turn, faces = turns[mesh.path], _faces(mesh)
        front = _times(viewer @ turn - faces.centres, faces.normals) > 0
        at = screen.place(_turned(faces.corners[front].reshape(-1, 3), turn)).reshape(-1, 4, 3)
        found.append(at)
        depths.append(at[..., 2].mean(axis=1) + faces.lifts[front])
        bright = _turned(faces.normals[front], (light @ turn)[None])[:, 0]
        colours.append(_shaded(faces.colours[front], bright))
    order = np.argsort(np.concatenate(depths), kind="stable")
    corners = np.concatenate(found)[order, :, :2]
    away = corners - corners.mean(axis=1, keepdims=True)
    length = np.maximum(np.hypot(away[..., 0], away[..., 1]), 1e-6)[..., None]
    return HeadDrawing(corners + away / length * OVERLAP_PX, np.concatenate(colours)[order])


def _turned(vectors: Floats, rows: Floats) -> Floats:
    """Return the products of vectors, (n, 3), with some rows, (m, 3): (n, m).

    `@` would wake the threads of the library for linear algebra, which take more time than these small products.
    """
    products: Floats = np.einsum("ij,kj->ik", vectors, rows)
    return products


def _times(one: Floats, other: Floats) -> Floats:
    products: Floats = np.einsum("ij,ij->i", one, other)
    return products


def _shaded(colours: npt.NDArray[np.uint8], bright: Floats) -> Whole:
    """Return colours for the brightness of each face, -1 to 1, in a limited number of shades."""
    steps = np.round(_lit(bright) * SHADES) / SHADES
    red, green, blue = np.clip(colours * steps[:, None], 0, 255).astype(np.int64).T
    shaded: Whole = (red << 16) | (green << 8) | blue
    return shaded


def _lit(bright: Floats) -> Floats:
    """Return the share of the full colour for a brightness of -1 to 1."""
    lit: Floats = DARKEST + (1 - DARKEST) * np.clip(0.5 + 0.62 * bright, 0.0, 1.0)
    return lit


def hull(points: Floats) -> Floats:
    """Return the corners of the convex hull of points, (n, 2), without those that differ little from their neighbours.

    They are the furthest points in HULL directions.
    """
    turn = np.arange(HULL) / HULL * math.tau
    away = np.outer(points[:, 0], np.cos(turn)) + np.outer(points[:, 1], np.sin(turn))
    furthest = away.argmax(axis=0)
    corners: Floats = points[furthest[furthest != np.roll(furthest, 1)]]
    return corners
