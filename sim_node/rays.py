"""Drawing without OpenGL: one ray a pixel, cast by MuJoCo itself, shaded by the angle to the light."""

from __future__ import annotations

import math
from typing import Final

import mujoco
import numpy as np
import numpy.typing as npt

from beatrix_zenoh._generated.robot import RobotData
from sim_node.gl import Image
from sim_node.looks import SKY, TILE, TILES, VISUAL
from sim_node.model import Vector, build_spec

_FAR: Final = 8.0
"""The floor fades into the sky up to here (m)."""
_AMBIENT: Final = 0.42
_LIGHT: Final = 0.62
_FILL: Final = 0.16
_TO_LIGHT: Final = np.array((0.42, -0.45, 0.79))
_TO_FILL: Final = np.array((0.58, -0.72, 0.36))


class RayPainter:
    """Draws the robot from one of its model's cameras, without shadows."""

    def __init__(self, robot: RobotData, width: int, height: int) -> None:
        """Images of `width` x `height` pixels."""
        self._model = model = _all_in_reach(robot)
        self._data = mujoco.MjData(model)
        self._shape = height, width
        self._group = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._group[VISUAL] = 1
        self._floor = model.geom("floor").id
        colours = np.where(model.geom_matid[:, None] >= 0, model.mat_rgba[model.geom_matid], model.geom_rgba)
        self._colours: Vector = colours[:, :3].astype(np.float64)

    def paint(self, posture: Vector, camera: str) -> Image:
        """What a named camera sees of the robot in this posture, as `Plant.posture`."""
        self._data.qpos[:] = posture
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        eye = self._data.camera(camera).xpos.copy()
        rays = self._rays(camera)
        geoms, distances, normals = self._cast(eye, rays)
        return self._shade(eye + rays * distances[:, None], geoms, distances, normals)

    def _cast(self, eye: Vector, rays: Vector) -> tuple[npt.NDArray[np.int32], Vector, Vector]:
        """Geom (-1: none), distance (m) and normal that each ray meets."""
        count = len(rays)
        geoms, distances = np.empty(count, dtype=np.int32), np.empty(count)
        normals = np.zeros(3 * count)
        group, everything = self._group, mujoco.mjMAXVAL
        mujoco.mj_multiRay(
            *(self._model, self._data, eye, rays.ravel(), group, 1, -1),
            *(geoms, distances, normals, count, everything),
        )
        return geoms, distances, normals.reshape(-1, 3)

    def _shade(
        self, points: Vector, geoms: npt.NDArray[np.int32], distances: Vector, normals: Vector
    ) -> Image:
        hit = geoms >= 0
        paint = self._colours[geoms[hit]]
        floor = geoms[hit] == self._floor
        tiles = np.floor(points[hit][floor, :2] / TILE).sum(axis=1).astype(np.int64) % 2
        paint[floor] = np.array(TILES)[tiles]
        light = _AMBIENT + _LIGHT * np.clip(normals[hit] @ _TO_LIGHT, 0, 1)
        light += _FILL * np.clip(normals[hit] @ _TO_FILL, 0, 1)
        haze = np.where(floor, np.clip(distances[hit] / _FAR, 0, 1), 0)[:, None]
        colours = np.tile(np.array(SKY), (len(geoms), 1))
        colours[hit] = paint * light[:, None] * (1 - haze) + np.array(SKY) * haze
        image: Image = (np.clip(colours, 0, 1) * 255).astype(np.uint8).reshape(*self._shape, 3)
        return image

    def _rays(self, camera: str) -> Vector:
        """Unit directions through the centres of the pixels, shape (pixels, 3)."""
        height, width = self._shape
        half = math.tan(math.radians(float(self._model.camera(camera).fovy[0])) / 2)
        across = (2 * (np.arange(width) + 0.5) - width) / height * half
        up = (height - 2 * (np.arange(height) + 0.5)) / height * half
        x, y = np.meshgrid(across, up)
        rays = np.stack((x, y, np.full_like(x, -1.0)), axis=-1).reshape(-1, 3)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        turned: Vector = rays @ self._data.camera(camera).xmat.reshape(3, 3).T
        return turned


def _all_in_reach(robot: RobotData) -> mujoco.MjModel:
    """A model for looking at only: rays pass by all that lies outside the box around what can touch."""
    spec = build_spec(robot)
    for geom in spec.geoms:
        geom.contype = 1
    return spec.compile()
