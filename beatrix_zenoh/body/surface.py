"""Surfaces of solids, as faces with four corners, and how those of one body are joined to a mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.colours import Colour
from beatrix_zenoh.motion.rotation import Vector

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Numbers = npt.NDArray[np.intp]

SIDES: Final = ((0.0035, 4), (0.007, 6), (0.05, 16), (math.inf, 28))
"""Number of sides of a tube with a radius below a limit (m); twice as many of a fine one."""
SMALL: Final = 0.025
"""Largest half axis (m) below which an ellipsoid has fewer faces."""
ANGULAR: Final = 0.7
"""Roundness below which an ellipsoid needs more faces."""
FINENESS: Final = {"small": (12, 6), "large": (20, 12), "angular": (30, 14)}
"""Faces around and from bottom to top of ellipsoids; twice as many of fine ones."""
TWIST: Final = 24
"""Pieces of a fine twisted rod."""
INNER: Final = 0.88
"""Pitch radius of a ring gear's teeth, divided by its outer radius."""


@dataclass(frozen=True)
class Surface:
    """The surface of one solid, in the frame of its body."""

    points: Floats
    """(n, 3), in m"""
    faces: Numbers
    """(m, 4), counter-clockwise seen from outside; a triangle repeats its last corner"""
    colour: Colour
    contains: Callable[[Floats], Flags] | None = None
    """which points are inside, for solids that hide parts of others"""


@dataclass(frozen=True, eq=False)
class Mesh:
    """The surfaces of one body, in its frame."""

    path: str
    """names of the body's parents and its own, as in `Figure.rotations`"""
    points: Floats
    """(n, 3), in m"""
    faces: Numbers
    """(m, 4), as of a Surface"""
    colours: npt.NDArray[np.uint8]
    """(n, 3): red, green, blue of each point; no two solids share a point"""
    order: Floats
    """(n): from 0 for the first solid of the body to 1 after the last one; later ones lie on earlier ones"""

    @property
    def body(self) -> str:
        """The body's own name."""
        return self.path.rpartition("/")[2]

    @cached_property
    def normals(self) -> Floats:
        """Unit vectors at the points, (n, 3)."""
        corners = self.points[self.faces]
        across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        total = np.zeros_like(self.points)
        for corner in range(4):
            np.add.at(total, self.faces[:, corner], across)
        normals: Floats = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
        return normals

    def solids(self) -> Iterator[tuple[Colour, Numbers]]:
        """Yield the colour and the triangles, (k, 3) indices of points, of each solid that is not quite hidden."""
        order = self.order[self.faces[:, 0]]
        for faces in (self.faces[order == part] for part in np.unique(order)):
            red, green, blue = self.colours[faces[0, 0]].tolist()
            yield (red, green, blue), triangles(faces)


def triangles(faces: Numbers) -> Numbers:
    """Return the triangles of faces with four corners."""
    whole = faces[faces[:, 2] != faces[:, 3]]
    return np.concatenate((faces[:, :3], whole[:, [0, 2, 3]]))


def joined(path: str, surfaces: Sequence[Surface], *, cut: bool) -> Mesh:
    """Return the mesh of a body; `cut`: without what lies inside another solid, for painters without depth."""
    points, faces, count = [], [], 0
    for index, surface in enumerate(surfaces):
        own, shown = surface.points, surface.faces
        for k, other in enumerate(surfaces if cut else ()):
            if k != index and other.contains is not None:
                shown = shown[~other.contains(own)[shown].all(axis=1)]
        points.append(own)
        faces.append(shown + count)
        count += len(own)
    sizes = [len(own) for own in points]
    colours = np.array([surface.colour for surface in surfaces], dtype=np.uint8)
    order = np.arange(len(surfaces)) / len(surfaces)
    return Mesh(
        path,
        np.concatenate(points),
        np.concatenate(faces),
        np.repeat(colours, sizes, axis=0),
        np.repeat(order, sizes),
    )


class Modeller:
    """Collects the surfaces of each body; lengths in m, in the frame of the body."""

    def __init__(self, *, fine: bool) -> None:
        """Begin a `fine` model with round parts and toothed gears, or one of few faces for painters in software."""
        self.fine = fine
        self.bodies: dict[str, list[Surface]] = {}

    def meshes(self) -> tuple[Mesh, ...]:
        """Return the mesh of each body."""
        return tuple(joined(path, surfaces, cut=not self.fine) for path, surfaces in self.bodies.items())

    def ellipsoid(
        self, body: str, position: Vector, half_axes: Vector, colour: Colour, roundness: float = 1.0
    ) -> None:
        """Add an ellipsoid whose axes are parallel to those of the body; towards a roundness of 0 it becomes a box."""
        middle, size = np.array(position), np.array(half_axes)

        def contains(points: Floats) -> Flags:
            x, y, z = np.abs(np.moveaxis((points - middle) / size, -1, 0)) ** (2 / roundness)
            inside: Flags = x + y + z < 1.0
            return inside

        kind = "small" if max(half_axes) < SMALL else "angular" if roundness < ANGULAR else "large"
        around, high = (count * (2 if self.fine else 1) for count in FINENESS[kind])
        u = np.arange(around) / around * math.tau
        v = (np.arange(1, high) / high - 0.5) * math.pi
        cu, su, cv, sv = (_power(x, roundness) for x in (np.cos(u), np.sin(u), np.cos(v), np.sin(v)))
        rings = np.stack(
            (np.outer(cv, cu), np.outer(cv, su), np.repeat(sv[:, None], around, axis=1)), axis=-1
        )
        poles = [middle + size * (0.0, 0.0, end) for end in (-1.0, 1.0)]
        self._add(body, Surface(*_skin(middle + rings * size, *poles), colour, contains))

    def tube(
        self, body: str, path: Sequence[Vector] | Floats, radius: float, colour: Colour, *, box: bool = False
    ) -> None:
        """Add a tube with flat ends along a path; `box`: its section is a square with this radius."""
        sides = (
            4 if box else next(count for limit, count in SIDES if radius < limit) * (2 if self.fine else 1)
        )
        places = np.array(path, dtype=float)
        ways = np.diff(places, axis=0)
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        right = np.cross(ways[0], (0.0, 1.0, 0.0) if abs(ways[0][1]) < 0.9 else (1.0, 0.0, 0.0))
        right /= np.linalg.norm(right)
        turn = (np.arange(sides) + (0.5 if box else 0.0)) / sides * math.tau
        ring = (np.outer(np.cos(turn), right) + np.outer(np.sin(turn), np.cross(ways[0], right))) * radius
        rings = [places[0] + ring]
        for place, way, after in zip(places[1:], ways, (*ways[1:], ways[-1]), strict=True):
            mitre = way + after
            ring = ring - np.outer(ring @ mitre / (way @ mitre), way)
            rings.append(place + ring)
        self._add(body, Surface(*_capped(np.array(rings)), colour))

    def cylinder(
        self,
        body: str,
        position: Vector,
        axis: Vector,
        size: tuple[float, float],
        colour: Colour,
        *,
        box: bool = False,
    ) -> None:
        """Add a cylinder around `position` with its axis along a unit vector; `size` is radius and length."""
        radius, length = size
        half = np.array(axis) * length / 2
        self.tube(body, np.array((position - half, position + half)), radius, colour, box=box)

    def gear(self, body: str, height: float, size: tuple[float, float], teeth: int, colour: Colour) -> None:
        """Add a ring around the axis z with teeth inside; `size` is its outer radius and its thickness.

        In a model of few faces it is a disc.
        """
        radius, thickness = size
        if not self.fine:
            self.cylinder(body, (0.0, 0.0, height), (0.0, 0.0, 1.0), size, colour)
            return
        turn = np.linspace(0.0, math.tau, 4 * teeth, endpoint=False)
        inner = radius * INNER * (1.0 + 2.0 / teeth * np.tile((1.0, 1.0, -1.0, -1.0), teeth))
        edges = ((radius, -0.5), (radius, 0.5), (inner, 0.5), (inner, -0.5), (radius, -0.5))
        rings = [
            np.stack(
                (away * np.cos(turn), away * np.sin(turn), np.full(len(turn), height + up * thickness)),
                axis=1,
            )
            for away, up in edges
        ]
        self._add(body, Surface(*_skin(np.array(rings)), colour))

    def rod(
        self, body: str, ends: tuple[Vector, Vector], radius: float, size: tuple[float, float], colour: Colour
    ) -> None:
        """Add a flat bar along a great circle between two directions, twisted by 90 deg; `size`: width and thickness."""
        start, end = map(np.array, ends)
        angle = math.acos(float(np.clip(start @ end, -1.0, 1.0)))
        side = np.cross(start, end) / math.sin(angle)
        turn = (np.arange(16 if self.fine else 8) + 0.5) / (16 if self.fine else 8) * math.tau
        across, thick = (
            _power(part, 0.4) * length / 2
            for part, length in zip((np.cos(turn), np.sin(turn)), size, strict=True)
        )
        rings = []
        for part in np.linspace(0.0, 1.0, TWIST + 1 if self.fine else TWIST // 3 + 1):
            out = (math.sin((1 - part) * angle) * start + math.sin(part * angle) * end) / math.sin(angle)
            twist = part * math.pi / 2
            wide = math.cos(twist) * side + math.sin(twist) * out
            thin = np.cross(np.cross(side, out), wide)
            rings.append(out * radius + np.outer(across, wide) + np.outer(thick, thin))
        self._add(body, Surface(*_capped(np.array(rings)), colour))

    def _add(self, body: str, surface: Surface) -> None:
        self.bodies.setdefault(body, []).append(surface)


def _power(values: Floats, exponent: float) -> Floats:
    powers: Floats = np.sign(values) * np.abs(values) ** exponent
    return powers


def _skin(rings: Floats, *ends: Floats) -> tuple[Floats, Numbers]:
    """Return the faces between rings of points, (rings, points, 3), counter-clockwise seen from the last.

    `ends` are the points at which the skin begins and ends; without them it is open.
    """
    count, around, _ = rings.shape
    here, there = np.arange(around), np.roll(np.arange(around), -1)
    between = np.column_stack((here, there, there + around, here + around))
    faces = [between + low for low in range(0, (count - 1) * around, around)]
    points, last = [rings.reshape(-1, 3)], (count - 1) * around
    if ends:
        points.append(np.array(ends))
        first, final = np.full(around, count * around), np.full(around, count * around + 1)
        faces += [np.column_stack((first, there, here, here))]
        faces += [np.column_stack((here + last, there + last, final, final))]
    return np.concatenate(points), np.concatenate(faces)


def _capped(rings: Floats) -> tuple[Floats, Numbers]:
    """Return a skin with flat ends, whose edges stay sharp because they have points of their own."""
    points, faces = _skin(rings)
    for ring in (rings[0][::-1], rings[-1]):
        here, there = np.arange(len(ring)), np.roll(np.arange(len(ring)), -1)
        middle = np.full(len(ring), len(ring))
        faces = np.concatenate((faces, np.column_stack((here, there, middle, middle)) + len(points)))
        points = np.concatenate((points, ring, [ring.mean(axis=0)]))
    return points, faces
