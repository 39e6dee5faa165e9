"""The robot's figure as faces with four corners, for `head3d_scene`: numpy only, no Qt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.contract._generated.robot import COLOURS
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import Rotation
from beatrix_zenoh.recording.drawing import matrix, orientations
from beatrix_zenoh.recording.figure import Figure, Form, Solid, face_details

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.intp]

HEAD: Final = "head"
BASE: Final = "base"
SIDES_OF_BAR: Final = 6
SIDES_OF_THIN_BAR: Final = 4
SIDES_OF_CYLINDER: Final = 16
THIN: Final = 0.003
"""Radius (m) below which a bar has fewer sides. Bars have no ends, because they end in other parts."""
PIN: Final = 0.006
"""Radius (m) below which a cylinder has as few sides as a bar."""
WIDE: Final = 0.03
"""Radius (m) from which the ends of a cylinder are fans of triangles."""
SMALL: Final = 0.025
"""Largest half axis (m) below which an ellipsoid has fewer faces."""
FINENESS: Final = {"small": (12, 6), "large": (20, 12), "angular": (30, 14)}
"""Faces around and from bottom to top of ellipsoids."""
ANGULAR: Final = 0.7
"""Roundness below which an ellipsoid needs more faces."""
HALVINGS: Final = 12
LIFT: Final = 0.006
"""By how much (m) the parts on the skull count as nearer when faces are sorted; the last ones twice as much."""


@dataclass(frozen=True)
class Mesh:
    """Faces of one body, in its frame."""

    body: str
    """name as in `Figure.rotations`: the last part of the path"""
    corners: Floats
    """(m, 4, 3), in m, counter-clockwise seen from outside; a triangle repeats its last corner"""
    centres: Floats
    """(m, 3), in m"""
    normals: Floats
    """(m, 3), unit vectors"""
    colours: Floats
    """(m, 3), from 0 to 255"""
    lifts: Floats
    """(m), in m: see LIFT"""


@cache
def meshes(figure: Figure) -> tuple[Mesh, ...]:
    """Return the meshes of a robot, one for each body, without what lies inside another solid of the same body."""
    found = []
    for body in figure.bodies:
        name = body.path.rpartition("/")[2]
        solids = [*body.solids, *(face_details(figure.size) if name == HEAD else ())]
        if name == BASE:  # the mast is inside the ring gears, which are drawn as closed discs
            solids = [solid for solid in solids if solid.colour != COLOURS.metal]
        found.append(_mesh(name, solids))
    return tuple(found)


def _mesh(name: str, solids: list[Solid]) -> Mesh:
    corners, colours, lifts = [], [], []
    for index, solid in enumerate(solids):
        points, faces = _surface(solid)
        points = points @ matrix(solid.quaternion).T + np.array(solid.position)
        for k, other in enumerate(solids):
            if k != index and other.form is Form.ELLIPSOID:
                inside = _inside(points, other)
                if k < index:  # otherwise the other one covers what is left of the edge
                    points = _cut(points, faces, inside, other)
                faces = faces[~inside[faces].all(axis=1)]
        corners.append(points[faces])
        colours.append(np.tile(np.array(solid.colour, dtype=float), (len(faces), 1)))
        lifts.append(np.full(len(faces), LIFT * (1 + index / len(solids)) if name == HEAD and index else 0.0))
    at = np.concatenate(corners)
    normals = np.cross(at[:, 2] - at[:, 0], at[:, 3] - at[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Mesh(name, at, at.mean(axis=1), normals, np.concatenate(colours), np.concatenate(lifts))


def _cut(points: Floats, faces: Numbers, inside: Flags, other: Solid) -> Floats:
    """Move the points just inside an ellipsoid to its surface, along the edges that leave it."""
    edges = np.concatenate([faces[:, [k, (k + 1) % 4]] for k in range(4)])
    edges = np.concatenate((edges, edges[:, ::-1]))
    edges = edges[inside[edges[:, 0]] & ~inside[edges[:, 1]]]
    goal, count = np.zeros_like(points), np.zeros(len(points))
    np.add.at(goal, edges[:, 0], points[edges[:, 1]])
    np.add.at(count, edges[:, 0], 1.0)
    moved = count > 0
    start, way = points[moved], goal[moved] / count[moved, None] - points[moved]
    low, high = np.zeros(len(start)), np.ones(len(start))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        within = _inside(start + way * middle[:, None], other)
        low, high = np.where(within, middle, low), np.where(within, high, middle)
    points = points.copy()
    points[moved] = start + way * low[:, None]
    return points


def _inside(points: Floats, solid: Solid) -> Flags:
    x, y, z = np.abs(np.moveaxis((points - solid.position) / solid.size, -1, 0)) ** (2 / solid.roundness)
    inside: Flags = x + y + z < 1.0
    return inside


def _surface(solid: Solid) -> tuple[Floats, Numbers]:
    """Return points and faces of a solid in its own frame."""
    if solid.form is Form.ELLIPSOID:
        return _ellipsoid(solid)
    radius, length = solid.size
    if solid.form is Form.CYLINDER:
        sides = SIDES_OF_CYLINDER if radius > PIN else SIDES_OF_BAR
        return _tube(radius, (-length / 2, length / 2), sides)
    sides = SIDES_OF_THIN_BAR if radius < THIN else SIDES_OF_BAR
    return _tube(radius, (-radius / 2, length + radius / 2), sides, closed=False)


def _tube(
    radius: float, ends: tuple[float, float], sides: int, *, closed: bool = True
) -> tuple[Floats, Numbers]:
    turn = np.arange(sides) / sides * math.tau
    ring = np.column_stack((np.cos(turn), np.sin(turn))) * radius
    points = np.concatenate([np.column_stack((ring, np.full(sides, height))) for height in ends])
    faces = [(k, (k + 1) % sides, (k + 1) % sides + sides, k + sides) for k in range(sides)]
    if closed and radius < WIDE:
        for k in range(sides // 2 - 1):
            faces.append((k + sides, k + 1 + sides, 2 * sides - 2 - k, 2 * sides - 1 - k))
            faces.append((sides - 1 - k, sides - 2 - k, k + 1, k))
    elif closed:  # small faces are sorted better
        points = np.concatenate((points, [(0.0, 0.0, height) for height in ends]))
        faces += [(k + sides, (k + 1) % sides + sides, 2 * sides + 1, 2 * sides + 1) for k in range(sides)]
        faces += [((k + 1) % sides, k, 2 * sides, 2 * sides) for k in range(sides)]
    return points, np.array(faces, dtype=np.intp)


def _ellipsoid(solid: Solid) -> tuple[Floats, Numbers]:
    """Return a superquadric: `roundness` 1 is an ellipsoid, towards 0 it becomes a box."""
    kind = "small" if max(solid.size) < SMALL else "angular" if solid.roundness < ANGULAR else "large"
    around, high = FINENESS[kind]
    u = np.arange(around) / around * math.tau
    v = (np.arange(1, high) / high - 0.5) * math.pi
    e = solid.roundness
    cu, su, cv, sv = (np.sign(x) * np.abs(x) ** e for x in (np.cos(u), np.sin(u), np.cos(v), np.sin(v)))
    rings = np.stack(
        (np.outer(cv, cu), np.outer(cv, su), np.repeat(sv[:, None], around, axis=1)), axis=-1
    ).reshape(-1, 3)
    points = np.concatenate((rings, [(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)])) * np.array(solid.size)
    south, north, faces = len(rings), len(rings) + 1, []
    last = (high - 2) * around
    for k in range(around):
        n = (k + 1) % around
        faces += [(row + k, row + n, row + around + n, row + around + k) for row in range(0, last, around)]
        faces += [(south, n, k, k), (last + k, last + n, north, north)]
    return points, np.array(faces, dtype=np.intp)


def turns(figure: Figure, arms: Arms, head: Rotation) -> dict[str, Floats]:
    """Return the rotation matrix of each body from its frame to that of the base.

    Args:
        figure: the robot.
        arms: angles from home (rad).
        head: rows of the head's orientation.
    """
    by_path = orientations(figure, arms, head)
    return {BASE: np.eye(3)} | {path.rpartition("/")[2]: turn for path, turn in by_path.items()}
