"""The appearance of the simulated robot: shapes without mass or contact.

The shapes are those of `beatrix_zenoh.body`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.surface import Mesh
from beatrix_zenoh.colours import Colour
from beatrix_zenoh.contract._generated.robot import COLOURS, RobotData

VISUAL: Final = 2
"""Geom group of all visible geoms."""
COLLISION: Final = 3
"""Geom group of all geoms with mass; hidden."""

SKY: Final = (0.93, 0.95, 0.97)
MATERIALS: Final[dict[Colour, str]] = {
    getattr(COLOURS, name): name for name in COLOURS.__struct_fields__ if name not in ("yaw", "pitch", "roll")
}
"""The robot's materials by their colours."""
_GLOSSY: Final = {"visor", "white", "iris", "black"}


def add_visuals(spec: mujoco.MjSpec, robot: RobotData) -> None:
    """Add the visible geoms to a model that has its bodies."""
    for colour, name in MATERIALS.items():
        glossy = name in _GLOSSY
        spec.add_material(
            name=name,
            rgba=opaque(colour),
            specular=0.8 if glossy else 0.25,
            shininess=0.9 if glossy else 0.4,
        )
    add_meshes(spec, meshes(Figure(robot.geometry, robot.head), fine=True), VISUAL)


def opaque(colour: Colour) -> list[float]:
    """Return a colour as MuJoCo has it: red, green, blue and opacity, from 0 to 1."""
    return [*(part / 255 for part in colour), 1.0]


def add_meshes(spec: mujoco.MjSpec, shape: Iterable[Mesh], group: int) -> None:
    """Add a geom without mass and contact for each solid of each body; visible ones have a material."""
    for mesh in shape:
        body = spec.worldbody if mesh.body == "base" else spec.body(mesh.body)
        for number, (colour, triangles) in enumerate(mesh.solids()):
            used, faces = np.unique(triangles, return_inverse=True)
            name = f"{mesh.body}_{group}_{number}"
            spec.add_mesh(
                name=name,
                uservert=mesh.points[used].ravel(),
                userface=faces.astype(np.int32).ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
            geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, group=group, mass=0.0)
            geom.contype = geom.conaffinity = 0
            if group == VISUAL:
                geom.material = MATERIALS[colour]
            else:
                geom.rgba = opaque(colour)


def add_camera(
    world: mujoco.MjsBody, name: str, place: Sequence[float], target: Sequence[float], fovy: float
) -> None:
    """Add an upright camera at `place` that looks at `target` (m); `fovy` is the vertical angle of view (deg)."""
    ahead = np.asarray(target) - np.asarray(place)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    world.add_camera(name=name, pos=place, xyaxes=[*right, *np.cross(right, ahead)], fovy=fovy)
