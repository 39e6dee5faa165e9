"""Drawing without OpenGL: MuJoCo casts rays, and the angle to the light gives the shade."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import numpy.typing as npt

from sim_node.painter import Image, Painter
from sim_node.shapes import Vector
from sim_node.visuals import COLLISION, SKY, VISUAL


class RayPainter(Painter):
    """Draws without OpenGL and without shadows."""

    source = "rays"

    def __init__(self, spec: mujoco.MjSpec, width: int, height: int, *, cell: int = 1) -> None:
        """Prepare images of `width` x `height` pixels with a ray for each square of `cell` x `cell` pixels."""
        for geom in spec.geoms:  # MuJoCo's rays miss geoms outside the bounding box of contacts
            geom.contype = 1
        model = spec.compile()
        super().__init__(model)
        self._shape, self._cell = (height // cell, width // cell), cell
        self._group = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._group[VISUAL] = 1
        colours = np.where(model.geom_matid[:, None] >= 0, model.mat_rgba[model.geom_matid], model.geom_rgba)
        self._colours: Vector = colours[:, :3].astype(np.float64)

    def paint(self, camera: str) -> Image:
        """Draw the picture from the camera of this name."""
        eye = self.data.camera(camera).xpos.copy()
        rays = self._rays(camera)
        self._hide_outside_view(camera)
        geoms, normals = self._cast(eye, rays)
        colours = self._colours[geoms] * self._light(rays, normals)
        colours[geoms < 0] = SKY
        image: Image = (np.clip(colours, 0, 1) * 255).astype(np.uint8).reshape(*self._shape, 3)
        return image.repeat(self._cell, axis=0).repeat(self._cell, axis=1)

    def _hide_outside_view(self, camera: str) -> None:
        """Hide the geoms outside the cone around the picture, which halves the time of the rays."""
        model, data = self.model, self.data
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
        model.geom_group[:] = np.where(seen, self.groups_seen_from(camera), COLLISION)

    def _cast(self, eye: Vector, rays: Vector) -> tuple[npt.NDArray[np.int32], Vector]:
        """Return geom (-1: none) and normal at the hit of each ray."""
        count = len(rays)
        geoms, distances = np.empty(count, dtype=np.int32), np.empty(count)
        normals = np.zeros(3 * count)
        group, everything = self._group, mujoco.mjMAXVAL
        mujoco.mj_multiRay(
            *(self.model, self.data, eye, rays.ravel(), group, 1, -1),
            *(geoms, distances, normals, count, everything),
        )
        return geoms, normals.reshape(-1, 3)

    def _light(self, rays: Vector, normals: Vector) -> Vector:
        """Return the brightness at the hit of each ray in the lights of the model, shape (rays, 3)."""
        model = self.model
        head = model.vis.headlight
        light = np.maximum(-(rays * normals).sum(axis=1), 0)[:, None] * head.diffuse + head.ambient
        for direction, diffuse in zip(model.light_dir, model.light_diffuse, strict=True):
            light += np.maximum(normals @ -direction, 0)[:, None] * diffuse
        bright: Vector = np.minimum(light, 1.0)
        return bright

    def _rays(self, camera: str) -> Vector:
        """Return unit directions through the centres of the pixels, shape (pixels, 3)."""
        height, width = self._shape
        half = math.tan(math.radians(float(self.model.camera(camera).fovy[0])) / 2)
        across = (2 * (np.arange(width) + 0.5) - width) / height * half
        up = (height - 2 * (np.arange(height) + 0.5)) / height * half
        x, y = np.meshgrid(across, up)
        rays = np.stack((x, y, np.full_like(x, -1.0)), axis=-1).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        turned: Vector = rays @ self.data.camera(camera).xmat.reshape(3, 3).T
        return turned
