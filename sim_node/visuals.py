"""The appearance of the simulated robot: shapes without mass or contact, lights and the observer's camera.

The shapes are those of `recording.figure`, with meshes for gears, rods, skull and motors, and details of the face.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh.colours import Colour
from beatrix_zenoh.contract._generated.robot import COLOURS, SIZES, RobotData
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.figure import Figure, Form, Solid, bar, face_details
from sim_node.shapes import Shape, internal_gear, twisted_rod

VISUAL: Final = 2
"""Geom group of all visible geoms."""
COLLISION: Final = 3
"""Geom group of all geoms with mass; hidden."""

SKY: Final = (0.93, 0.95, 0.97)
TILES: Final = ((0.88, 0.885, 0.875), (0.845, 0.855, 0.85))
TILE: Final = 0.1
"""Side of the floor's tiles (m)."""

MATERIALS: Final[dict[Colour, str]] = {
    getattr(COLOURS, name): name for name in COLOURS.__struct_fields__ if name not in ("yaw", "pitch", "roll")
}
"""The robot's materials by their colours."""
_RINGS: Final = 22
"""Fineness of rounded meshes."""
_GLOSSY: Final = {"visor", "white", "iris", "black"}
_FORMS: Final = {
    Form.ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    Form.CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
    Form.CAPSULE: mujoco.mjtGeom.mjGEOM_CAPSULE,
}


def add_visuals(spec: mujoco.MjSpec, robot: RobotData) -> None:
    """Add the visible geoms, lights and cameras to a model that has its bodies."""
    for colour, name in MATERIALS.items():
        glossy = name in _GLOSSY
        spec.add_material(
            name=name,
            rgba=opaque(colour),
            specular=0.8 if glossy else 0.25,
            shininess=0.9 if glossy else 0.4,
        )
    _surroundings(spec)
    figure = Figure(robot.geometry, robot.head)
    for body in figure.bodies:
        for solid in body.solids:
            if not solid.mesh:
                add_solid(spec, body.path, solid, VISUAL, material=MATERIALS[solid.colour])
    for index, name in enumerate(ARMS):
        _motor(spec, robot, index)
        _chain(spec, robot, figure, index, name)
    for solid in face_details(robot.head):
        add_solid(spec, "head", solid, VISUAL, material=MATERIALS[solid.colour])


def opaque(colour: Colour) -> list[float]:
    """Return a colour as MuJoCo has it: red, green, blue and opacity, from 0 to 1."""
    return [*(part / 255 for part in colour), 1.0]


def add_solid(spec: mujoco.MjSpec, path: str, solid: Solid, group: int, **look: object) -> None:
    """Add a solid of a figure to the body of this path in the figure; `look` is its material, or its rgba."""
    x, y, z, w = solid.quaternion
    quat, pos, size = np.array((w, x, y, z)), np.array(solid.position), list(solid.size)
    if solid.roundness < 1:
        mesh = spec.add_mesh(name=f"rounded_{len(spec.meshes)}", scale=size)
        mesh.make_supersphere(_RINGS, solid.roundness, solid.roundness)
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        look |= {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": mesh.name}
    else:
        if solid.form is not Form.ELLIPSOID:
            size[1] /= 2  # MuJoCo wants half of the length
        if solid.form is Form.CAPSULE:
            axis = np.zeros(3)
            mujoco.mju_rotVecQuat(axis, np.array((0.0, 0.0, 1.0)), quat)
            pos = pos + axis * size[1]
        look |= {"type": _FORMS[solid.form], "size": [*size, 0.0][:3]}
    _add_geom(spec, path, group, pos=pos, quat=quat, **look)


def _add_geom(spec: mujoco.MjSpec, path: str, group: int = VISUAL, **shape: object) -> None:
    """Add a geom without mass and contact to the body of this path in a figure."""
    name = path.rpartition("/")[2]
    body = spec.worldbody if name == "base" else spec.body(name)
    geom = body.add_geom(group=group, mass=0.0, **shape)
    geom.contype = geom.conaffinity = 0


def _add_mesh(
    spec: mujoco.MjSpec, path: str, material: str, name: str, shape: Shape, pos: Sequence[float] = (0, 0, 0)
) -> None:
    """Add a mesh; `shape` is used only for the first mesh of this name."""
    if not any(mesh.name == name for mesh in spec.meshes):
        spec.add_mesh(
            name=name,
            uservert=shape.vertices.ravel(),
            userface=shape.faces.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
    _add_geom(spec, path, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=material, pos=pos)


def _surroundings(spec: mujoco.MjSpec) -> None:
    world = spec.worldbody
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.80, 0.86, 0.92],
        rgb2=SKY,
        width=256,
        height=256 * 6,
    )
    spec.add_texture(
        name="tiles",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=TILES[0],
        rgb2=TILES[1],
        width=256,
        height=256,
    )
    floor = spec.add_material(name="floor", texrepeat=[0.5 / TILE, 0.5 / TILE], texuniform=True, specular=0.1)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    plane = world.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 0.1],
        pos=[0, 0, SIZES.floor],
        material="floor",
        group=VISUAL,
    )
    plane.contype = plane.conaffinity = 0
    sun = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    world.add_light(type=sun, pos=[0.6, -0.5, 1.2], dir=[-0.5, 0.55, -1.1], diffuse=[0.60, 0.59, 0.56])
    fill = world.add_light(type=sun, pos=[1.0, -1.2, 0.6], dir=[-0.8, 1.0, -0.5], diffuse=[0.20, 0.21, 0.23])
    fill.castshadow = False
    add_camera(world, "observer", (0.80, -0.56, 0.20), (0.0, 0.0, 0.012), 28.0)
    visual = spec.visual
    visual.headlight.ambient = [0.30, 0.30, 0.32]
    visual.headlight.diffuse = [0.20, 0.20, 0.20]
    visual.headlight.specular = [0.1, 0.1, 0.1]
    visual.quality.shadowsize = 4096
    visual.map.znear = 0.02
    visual.map.shadowclip = 0.8
    visual.map.zfar = 12.0
    visual.rgba.haze = [*SKY, 1.0]
    spec.stat.center, spec.stat.extent = [0.0, 0.0, 0.0], 1.0


def add_camera(
    world: mujoco.MjsBody, name: str, place: Sequence[float], target: Sequence[float], fovy: float
) -> None:
    """Add an upright camera at `place` that looks at `target` (m); `fovy` is the vertical angle of view (deg)."""
    ahead = np.asarray(target) - np.asarray(place)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    world.add_camera(name=name, pos=place, xyaxes=[*right, *np.cross(right, ahead)], fovy=fovy)


def _motor(spec: mujoco.MjSpec, robot: RobotData, index: int) -> None:
    """Add a motor with its shaft and the pinion inside the ring gear of its arm."""
    drive, height = robot.drive, SIZES.ring_heights[index]
    module = SIZES.ring_radius * 0.88 * 2 / drive.gear_ring
    azimuth = math.radians(robot.geometry.arm0_azimuth + 60.0 + 120.0 * index)
    away = module * (drive.gear_ring - drive.gear_pinion) / 2
    x, y = away * math.cos(azimuth), away * math.sin(azimuth)
    box, cylinder = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER
    for material, form, size, z in (
        ("motor", box, (0.021, 0.021, 0.017), -0.150),
        ("metal", box, (0.0212, 0.0212, 0.005), -0.132),
        ("metal", cylinder, (module * drive.gear_pinion / 2, SIZES.ring_thickness / 2, 0.0), height),
    ):
        _add_geom(spec, "base", type=form, size=size, pos=(x, y, z), material=material)
    (shaft,) = bar([(x, y, -0.13), (x, y, height)], 0.0025, COLOURS.metal)
    add_solid(spec, "base", shaft, VISUAL, material="metal")


def _chain(spec: mujoco.MjSpec, robot: RobotData, figure: Figure, index: int, name: str) -> None:
    """Add the ring gear and the twisted rod of an arm."""
    radius, teeth = SIZES.ring_radius, robot.drive.gear_ring
    gear = internal_gear(radius, radius * 0.88, SIZES.ring_thickness, teeth)
    _add_mesh(spec, f"arm_{name}", name, "ring", gear, (0.0, 0.0, SIZES.ring_heights[index]))
    _, elbow, mount = figure.chains[index]
    rod = twisted_rod(np.array(elbow), np.array(mount), robot.head.arm_length, 0.014, 0.0065)
    _add_mesh(spec, f"rod_{name}", "rod", f"rod_{name}", rod)
