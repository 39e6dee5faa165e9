"""Draws the model of a robot as a picture, without a graphics card.

The projection is parallel, so each solid is a quadric whose depth at a pixel is the root of a quadratic equation. Each
solid is drawn into the rectangle that it covers, and a buffer of depths decides which solid is visible.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import Rotation, rotation_of
from beatrix_zenoh.recording.figure import Figure, Form, Quaternion, Solid

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]
"""(height, width, 3) red, green, blue"""

BACKGROUND: Final = (236, 239, 243)
VIEW: Final = (0.46, -0.28, 0.125)
"""Direction from the head to the viewer, as in the recording's side-by-side view."""
CENTRE_HEIGHT_M: Final = -0.002
VISIBLE_M: Final = 0.46
"""Height that the picture shows."""
LIGHT: Final = (0.25, 0.55, 0.80)
"""Direction to the light, in coordinates of the picture: right, up, towards the viewer."""
AMBIENT: Final = 0.45
SMOOTHING: Final = 2
"""Pixels are drawn this much smaller in both directions, and averaged."""


class PoseRenderer:
    """Pictures of one robot in the poses that are asked for."""

    def __init__(self, figure: Figure, width: int, height: int) -> None:
        """Prepare pictures of this size (pixels)."""
        self._figure = figure
        self._shape = (height * SMOOTHING, width * SMOOTHING)
        self._scale = height * SMOOTHING / VISIBLE_M
        self._camera = camera()
        self._light = np.array(LIGHT) / np.linalg.norm(LIGHT)
        self._last: tuple[tuple[float, ...], Pixels] | None = None
        still = figure.rotations((0.0, 0.0, 0.0), rotation_of(0.0, 0.0, 0.0)).keys()
        self._base = self._empty()
        for body in figure.bodies:
            if body.path not in still:
                self._draw_body(self._base, body.solids, np.eye(3))

    def picture(self, arms_deg: Array, head_deg: Array) -> Pixels:
        """Return the picture of a pose: angles of the arms, and yaw, pitch and roll of the head (deg)."""
        pose = (*arms_deg.tolist(), *head_deg.tolist())
        if self._last is None or max(abs(a - b) for a, b in zip(pose, self._last[0], strict=True)) > 0.02:
            self._last = pose, self._drawn(pose)
        return self._last[1]

    def _drawn(self, pose: tuple[float, ...]) -> Pixels:
        short, middle, long, *head = (math.radians(angle) for angle in pose)
        turns = orientations(self._figure, (short, middle, long), rotation_of(*head))
        depth, colour = self._base[0].copy(), self._base[1].copy()
        for body in self._figure.bodies:
            if body.path in turns:
                self._draw_body((depth, colour), body.solids, turns[body.path])
        return averaged(colour)

    def _empty(self) -> tuple[Array, Pixels]:
        colour = np.empty((*self._shape, 3), np.uint8)
        colour[:] = BACKGROUND
        return np.full(self._shape, -np.inf), colour

    def _draw_body(self, buffers: tuple[Array, Pixels], solids: tuple[Solid, ...], turn: Array) -> None:
        for solid in solids:
            axes = self._camera @ turn @ matrix(solid.quaternion)
            centre = self._camera @ (turn @ np.array(solid.position) - (0.0, 0.0, CENTRE_HEIGHT_M))
            if solid.form is Form.ELLIPSOID:
                self._draw_ellipsoid(buffers, centre, axes, np.array(solid.size), solid)
                continue
            radius, length = solid.size
            along = axes[:, 2]
            if solid.form is Form.CAPSULE:
                for end in (centre, centre + along * length):
                    self._draw_ellipsoid(buffers, end, axes, np.full(3, radius), solid)
                centre = centre + along * length / 2
            self._draw_cylinder(buffers, centre, along, radius, length, solid)

    def _draw_ellipsoid(
        self, buffers: tuple[Array, Pixels], centre: Array, axes: Array, half: Array, solid: Solid
    ) -> None:
        """Draw an ellipsoid: (p - centre)ᵀ A (p - centre) = 1."""
        window, x, y = self._window(centre, np.sqrt((axes**2 @ half**2)[:2]))
        a = (axes / half**2) @ axes.T
        slope = a[0, 2] * x + a[1, 2] * y
        rest = a[0, 0] * x * x + 2 * a[0, 1] * x * y + a[1, 1] * y * y - 1.0
        root = slope * slope - a[2, 2] * rest
        z = (np.sqrt(np.maximum(root, 0.0)) - slope) / a[2, 2]
        points = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
        self._fill(buffers, window, root >= 0, z + centre[2], points @ a, solid)

    def _draw_cylinder(
        self,
        buffers: tuple[Array, Pixels],
        centre: Array,
        along: Array,
        radius: float,
        length: float,
        solid: Solid,
    ) -> None:
        """Draw the mantle |p - (p·along) along| = radius within the length, and the end that faces the viewer."""
        across = np.sqrt(np.maximum(1.0 - along[:2] ** 2, 0.0)) * radius
        window, x, y = self._window(centre, np.abs(along[:2]) * length / 2 + across)
        x, y = np.broadcast_arrays(x, y)
        ends = np.sign(along[2]) * along
        if solid.form is Form.CYLINDER and ends[2] > 1e-6:
            z = (length / 2 - ends[0] * x - ends[1] * y) / ends[2]
            inside = x * x + y * y + z * z - (length / 2) ** 2 <= radius * radius
            self._fill(buffers, window, inside, z + centre[2], np.broadcast_to(ends, (*x.shape, 3)), solid)
        steep = 1.0 - along[2] ** 2
        if steep < 1e-9:
            return
        known = along[0] * x + along[1] * y
        slope = -along[2] * known
        root = slope * slope - steep * (x * x + y * y - known * known - radius * radius)
        z = (np.sqrt(np.maximum(root, 0.0)) - slope) / steep
        place = known + along[2] * z
        normals = np.stack((x, y, z), axis=-1) - place[..., None] * along
        inside = (root >= 0) & (np.abs(place) <= length / 2)
        self._fill(buffers, window, inside, z + centre[2], normals, solid)

    def _window(self, centre: Array, half: Array) -> tuple[tuple[slice, slice], Array, Array]:
        """Return the pixels within `half` (m; right, up) around a centre, and their distances from it (m)."""
        height, width = self._shape
        left, right = (width / 2 + (centre[0] + side * half[0]) * self._scale for side in (-1, 1))
        top, bottom = (height / 2 - (centre[1] + side * half[1]) * self._scale for side in (1, -1))
        columns = np.arange(max(0, int(left)), min(width, int(right) + 2))
        rows = np.arange(max(0, int(top)), min(height, int(bottom) + 2))
        x = (columns + 0.5 - width / 2) / self._scale - centre[0]
        y = (height / 2 - rows - 0.5) / self._scale - centre[1]
        window = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        return window, x[None, :], y[:, None]

    def _fill(
        self,
        buffers: tuple[Array, Pixels],
        window: tuple[slice, slice],
        inside: npt.NDArray[np.bool_],
        depth: Array,
        normals: Array,
        solid: Solid,
    ) -> None:
        """Colour the pixels of a surface that no nearer surface hides."""
        depths, colours = buffers[0][window], buffers[1][window]
        visible = inside & (depth > depths)
        if not visible.any():
            return
        shown = normals[visible]
        light = shown @ self._light / np.sqrt((shown * shown).sum(axis=-1))
        shade = AMBIENT + (1.0 - AMBIENT) * np.maximum(light, 0.0)
        depths[visible] = depth[visible]
        colours[visible] = (shade[:, None] * solid.colour).astype(np.uint8)


def averaged(fine: Pixels) -> Pixels:
    """Return a picture with a SMOOTHING-th of the pixels in both directions."""
    total = np.zeros((fine.shape[0] // SMOOTHING, fine.shape[1] // SMOOTHING, 3), np.uint16)
    for row in range(SMOOTHING):  # mean() over the axes takes ten times as long
        for column in range(SMOOTHING):
            total += fine[row::SMOOTHING, column::SMOOTHING]
    return (total // SMOOTHING**2).astype(np.uint8)


def camera() -> Array:
    """Return the rows right, up and towards the viewer of the picture, in coordinates of the robot."""
    towards = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 0.0, 1.0), towards)
    right /= np.linalg.norm(right)
    return np.array((right, np.cross(towards, right), towards))


def orientations(figure: Figure, arms: Arms, head: Rotation) -> dict[str, Array]:
    """Return the rotation matrix of each body that turns, from its frame to that of the robot, by its path.

    Args:
        figure: the robot.
        arms: angles from home (rad).
        head: rows of the head's orientation.
    """
    found: dict[str, Array] = {}
    for path, quaternion in figure.rotations(arms, head).items():
        parent, _, _ = path.rpartition("/")
        turn = matrix(quaternion)
        found[path] = found[parent] @ turn if parent else turn
    return found


def matrix(turn: Quaternion) -> Array:
    """Return the rotation matrix of a quaternion."""
    x, y, z, w = turn
    return np.array((
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    ))  # fmt: skip
