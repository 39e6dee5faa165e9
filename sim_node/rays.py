"""Drawing without OpenGL: MuJoCo casts rays, and the angle to the light gives the shade."""

from __future__ import annotations

import math
from typing import Final

import mujoco
import numpy as np
import numpy.typing as npt

from sim_node.painter import Image, PosedModel
from sim_node.shapes import Point, Vector
from sim_node.visuals import COLLISION, SKY, TILE, TILES, VISUAL

_FAR: Final = 8.0
"""Distance at which the floor has the colour of the sky (m)."""


class RayPainter:
    """Draws without OpenGL and without shadows; a `Painter`."""

    source: Final = "rays"

    def __init__(self, spec: mujoco.MjSpec, width: int, height: int, *, cell: int = 1) -> None:
        """Prepare images of `width` x `height` pixels with a ray for each square of `cell` x `cell` pixels."""
        model = _compile_for_rays(spec)
        self._posed = PosedModel(model)
        self._shape, self._cell = (height // cell, width // cell), cell
        self._group = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._group[VISUAL] = 1
        self._floor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "floor")
        colours = np.where(model.geom_matid[:, None] >= 0, model.mat_rgba[model.geom_matid], model.geom_rgba)
        self._colours: Vector = colours[:, :3].astype(np.float64)

    def pose(self, posture: Vector, target: Point | None = None) -> None:
        """Set the posture and the person's place as `PosedModel.pose` does."""
        self._posed.pose(posture, target)

    def paint(self, camera: str) -> Image:
        """Draw the picture from the camera of this name."""
        eye = self._posed.data.camera(camera).xpos.copy()
        rays = self._rays(camera)
        self._hide_outside_view(camera)
        geoms, distances, normals = self._cast(eye, rays)
        image = self._shade(eye, rays, geoms, distances, normals)
        return image.repeat(self._cell, axis=0).repeat(self._cell, axis=1)

    def close(self) -> None:
        """Do nothing: there are no resources to free."""

    def _hide_outside_view(self, camera: str) -> None:
        """Hide the geoms outside the cone around the picture, which halves the time of the rays."""
        model, data = self._posed.model, self._posed.data
        height, width = self._shape
        half = math.tan(math.radians(float(model.camera(camera).fovy[0])) / 2)
        cone = math.atan(half * math.hypot(1.0, width / height))
        away = data.geom_xpos - data.camera(camera).xpos
        distance = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
        ahead = -data.camera(camera).xmat.reshape(3, 3)[:, 2]
        angle = np.arccos(np.clip(away @ ahead / distance, -1.0, 1.0))
        # In MuJoCo a bounding radius of 0 means an infinite plane, which may be visible everywhere.
        radius = np.where(model.geom_rbound > 0, model.geom_rbound, np.inf)
        seen = angle - np.arcsin(np.minimum(radius / distance, 1.0)) < cone
        model.geom_group[:] = np.where(seen, self._posed.groups_seen_from(camera), COLLISION)

    def _cast(self, eye: Vector, rays: Vector) -> tuple[npt.NDArray[np.int32], Vector, Vector]:
        """Return geom (-1: none), distance (m) and normal at the hit of each ray."""
        count = len(rays)
        geoms, distances = np.empty(count, dtype=np.int32), np.empty(count)
        normals = np.zeros(3 * count)
        group, everything = self._group, mujoco.mjMAXVAL
        mujoco.mj_multiRay(
            *(self._posed.model, self._posed.data, eye, rays.ravel(), group, 1, -1),
            *(geoms, distances, normals, count, everything),
        )
        return geoms, distances, normals.reshape(-1, 3)

    def _shade(
        self,
        eye: Vector,
        rays: Vector,
        geoms: npt.NDArray[np.int32],
        distances: Vector,
        normals: Vector,
    ) -> Image:
        hit = geoms >= 0
        colours = self._colours[geoms] * self._light(rays, normals)
        floor = geoms == self._floor
        if floor.any():
            points = eye + rays[floor] * distances[floor, None]
            tiles = np.floor(points[:, :2] / TILE).sum(axis=1).astype(np.int64) % 2
            colours[floor] *= np.array(TILES)[tiles] / self._colours[self._floor]
            haze = np.clip(distances[floor] / _FAR, 0, 1)[:, None]
            colours[floor] = colours[floor] * (1 - haze) + np.array(SKY) * haze
        colours[~hit] = SKY
        image: Image = (np.clip(colours, 0, 1) * 255).astype(np.uint8).reshape(*self._shape, 3)
        return image

    def _light(self, rays: Vector, normals: Vector) -> Vector:
        """Return the brightness at the hit of each ray in the lights of the model, shape (rays, 3)."""
        model = self._posed.model
        head = model.vis.headlight
        light = np.maximum(-(rays * normals).sum(axis=1), 0)[:, None] * head.diffuse + head.ambient
        for direction, diffuse in zip(model.light_dir, model.light_diffuse, strict=True):
            light += np.maximum(normals @ -direction, 0)[:, None] * diffuse
        bright: Vector = np.minimum(light, 1.0)
        return bright

    def _rays(self, camera: str) -> Vector:
        """Return unit directions through the centres of the pixels, shape (pixels, 3)."""
        height, width = self._shape
        half = math.tan(math.radians(float(self._posed.model.camera(camera).fovy[0])) / 2)
        across = (2 * (np.arange(width) + 0.5) - width) / height * half
        up = (height - 2 * (np.arange(height) + 0.5)) / height * half
        x, y = np.meshgrid(across, up)
        rays = np.stack((x, y, np.full_like(x, -1.0)), axis=-1).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        turned: Vector = rays @ self._posed.data.camera(camera).xmat.reshape(3, 3).T
        return turned


def _compile_for_rays(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile the model with contact for all geoms: MuJoCo's rays miss geoms outside the bounding box of contacts."""
    for geom in spec.geoms:
        geom.contype = 1
    return spec.compile()
