"""The appearance of the simulated robot: shapes without mass or contact, lights and the observer's camera.

The short arm is red, the middle one green, the long one blue, and the twisted rods are yellow. The face points along x.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh import colours
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract.names import ARMS
from sim_node.shapes import Shape, Vector, internal_gear, superellipsoid, twisted_rod

Numbers = Sequence[float] | Vector

VISUAL: Final = 2
"""Geom group of all visible geoms."""
COLLISION: Final = 3
"""Geom group of all geoms with mass; hidden."""
RING_RADIUS: Final = 0.046
"""Radius of the ring gears (m)."""
RING_HEIGHT: Final = 0.013
POST_RADIUS: Final = 0.054
"""Distance of the arms' uprights from the axis (m)."""
EYE_FORWARD: Final = 0.107
"""Distance of the cameras from the neck centre (m)."""
EYE_UP: Final = 0.018
"""Height of the cameras above the head's centre of mass (m)."""

SKY: Final = (0.93, 0.95, 0.97)
TILES: Final = ((0.88, 0.885, 0.875), (0.845, 0.855, 0.85))
TILE: Final = 0.1
"""Side of the floor's tiles (m)."""

FLOOR: Final = -0.206
"""Height of the surface under the robot (m)."""
_SPHERE: Final = mujoco.mjtGeom.mjGEOM_SPHERE
_CAPSULE: Final = mujoco.mjtGeom.mjGEOM_CAPSULE
_ELLIPSOID: Final = mujoco.mjtGeom.mjGEOM_ELLIPSOID
_CYLINDER: Final = mujoco.mjtGeom.mjGEOM_CYLINDER
_BOX: Final = mujoco.mjtGeom.mjGEOM_BOX

_GLOSSY: Final = {"visor", "white", "iris", "black"}
MATERIALS: Final[dict[str, tuple[float, float, float]]] = {
    "shell": (0.93, 0.92, 0.89),
    "visor": (0.13, 0.16, 0.20),
    "white": (0.99, 0.99, 0.98),
    "iris": (0.10, 0.55, 0.62),
    "black": (0.03, 0.03, 0.04),
    "trim": (0.30, 0.34, 0.39),
    "cheek": (0.95, 0.62, 0.56),
    "rod": (0.98, 0.78, 0.12),
    "metal": (0.66, 0.68, 0.70),
    "motor": (0.30, 0.31, 0.34),
    "base": (0.24, 0.27, 0.31),
} | {name: (red / 255, green / 255, blue / 255) for name, (red, green, blue) in colours.ARMS.items()}
"""Colours of the robot's materials, from 0 to 1."""


def ring_height(index: int) -> float:
    """Return the height (m) of an arm's ring gear; the short arm's is on top."""
    return -0.068 - 0.019 * index


class VisualGeoms:
    """Adds visual geoms to the bodies of a model."""

    def __init__(self, spec: mujoco.MjSpec, materials: Mapping[str, tuple[float, float, float]]) -> None:
        """Add a material of each of these colours: red, green, blue from 0 to 1."""
        self._spec = spec
        for name, colour in materials.items():
            glossy = name in _GLOSSY
            spec.add_material(
                name=name,
                rgba=[*colour, 1.0],
                specular=0.8 if glossy else 0.25,
                shininess=0.9 if glossy else 0.4,
            )

    def primitive(
        self,
        body: str,
        material: str,
        shape: mujoco.mjtGeom,
        size: Sequence[float],
        pos: Numbers = (0.0, 0.0, 0.0),
        axis: Numbers = (0.0, 0.0, 1.0),
    ) -> None:
        """Add a primitive (m) to a body at `pos`, with its z axis along `axis`."""
        self._geom(body, material, type=shape, size=[*size, 0.0, 0.0][:3], pos=list(pos), zaxis=list(axis))

    def bar(
        self,
        body: str,
        material: str,
        radius: float,
        *points: Numbers,
        shape: mujoco.mjtGeom = _CAPSULE,
    ) -> None:
        """Add a round bar of this radius (m) through points."""
        for start, end in itertools.pairwise(points):
            self._geom(body, material, type=shape, size=[radius, 0.0, 0.0], fromto=[*start, *end])

    def mesh(self, body: str, material: str, name: str, shape: Shape, pos: Numbers = (0.0, 0.0, 0.0)) -> None:
        """Add a mesh; `shape` is used only for the first mesh of this name."""
        if not any(mesh.name == name for mesh in self._spec.meshes):
            self._spec.add_mesh(
                name=name,
                uservert=shape.vertices.ravel(),
                userface=shape.faces.ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
        self._geom(body, material, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, pos=list(pos))

    def _geom(self, body: str, material: str, **shape: object) -> mujoco.MjsGeom:
        geom = self._spec.body(body).add_geom(material=material, group=VISUAL, mass=0.0, **shape)
        geom.contype = geom.conaffinity = 0
        return geom


def _vector(x: float, y: float, z: float) -> Vector:
    return np.array((x, y, z))


def add_visuals(spec: mujoco.MjSpec, robot: RobotData) -> None:
    """Add the visible geoms, lights and cameras to a model that has its bodies."""
    visuals = VisualGeoms(spec, MATERIALS)
    _surroundings(spec)
    _base(visuals, robot)
    for index, name in enumerate(ARMS):
        _chain(spec, visuals, robot, index, name)
    _neck(spec, visuals)
    _skull(visuals, robot.head.centre_height)
    _face(visuals, robot)


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
        pos=[0, 0, FLOOR],
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


def add_camera(world: mujoco.MjsBody, name: str, place: Numbers, target: Numbers, fovy: float) -> None:
    """Add an upright camera at `place` that looks at `target` (m); `fovy` is the vertical angle of view (deg)."""
    ahead = np.asarray(target) - np.asarray(place)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    world.add_camera(name=name, pos=place, xyaxes=[*right, *np.cross(right, ahead)], fovy=fovy)


def _base(visuals: VisualGeoms, robot: RobotData) -> None:
    visuals.primitive("world", "base", _CYLINDER, (0.085, 0.006), (0, 0, FLOOR + 0.006))
    visuals.primitive("world", "trim", _CYLINDER, (0.088, 0.003), (0, 0, FLOOR + 0.003))
    visuals.primitive("world", "base", _CYLINDER, (0.062, 0.003), (0, 0, -0.124))
    visuals.bar("world", "metal", 0.007, (0, 0, -0.124), (0, 0, -0.058))
    module = RING_RADIUS * 0.88 * 2 / robot.drive.gear_ring
    for index in range(3):
        azimuth = math.radians(robot.geometry.arm0_azimuth + 60.0 + 120.0 * index)
        away = np.array((math.cos(azimuth), math.sin(azimuth), 0.0))
        at = away * module * (robot.drive.gear_ring - robot.drive.gear_pinion) / 2
        visuals.primitive(
            "world", "motor", _BOX, (0.021, 0.021, 0.017), at + _vector(0, 0, -0.150), (0, 0, 1)
        )
        visuals.primitive(
            "world", "metal", _BOX, (0.0212, 0.0212, 0.005), at + _vector(0, 0, -0.132), (0, 0, 1)
        )
        height = ring_height(index)
        visuals.bar("world", "metal", 0.0025, at + _vector(0, 0, -0.13), at + _vector(0, 0, height))
        pinion = module * robot.drive.gear_pinion / 2
        visuals.primitive("world", "metal", _CYLINDER, (pinion, RING_HEIGHT / 2), at + _vector(0, 0, height))
        post = away * -0.075
        visuals.bar("world", "trim", 0.005, post + _vector(0, 0, FLOOR), post * 0.75 + _vector(0, 0, -0.124))


def _chain(spec: mujoco.MjSpec, visuals: VisualGeoms, robot: RobotData, index: int, name: str) -> None:
    elbow = np.array(spec.joint(f"rod_{name}").axis)
    mount = np.array(spec.site(f"rod_{name}").pos)
    out = np.array((elbow[0], elbow[1], 0.0)) / np.hypot(elbow[0], elbow[1])
    height = np.array((0.0, 0.0, ring_height(index)))
    reach = robot.head.arm_length
    gear = internal_gear(RING_RADIUS, RING_RADIUS * 0.88, RING_HEIGHT, robot.drive.gear_ring)
    visuals.mesh(f"arm_{name}", name, "ring", gear, height)
    post = out * POST_RADIUS
    visuals.bar(
        f"arm_{name}",
        name,
        0.0052,
        out * RING_RADIUS + height,
        post + height,
        elbow * reach * 1.27,
        elbow * reach * 1.1,
    )
    visuals.bar(f"arm_{name}", "metal", 0.0032, elbow * reach * 0.93, elbow * reach * 1.27, shape=_CYLINDER)
    rod = twisted_rod(elbow, mount / np.linalg.norm(mount), reach, 0.014, 0.0065)
    visuals.mesh(f"rod_{name}", "rod", f"rod_{name}", rod)
    for axis, length in ((elbow, reach), (mount / np.linalg.norm(mount), robot.head.mount_radius)):
        visuals.primitive(f"rod_{name}", "rod", _CYLINDER, (0.0085, 0.0036), axis * length, axis)


def _neck(spec: mujoco.MjSpec, visuals: VisualGeoms) -> None:
    """Add the hub and the three spokes between the ends of the rods and the skull."""
    top = np.array((0.0, 0.0, 0.040))
    for name in ARMS:
        mount = np.array(spec.site(f"mount_{name}").pos)
        axis = mount / np.linalg.norm(mount)
        visuals.bar("head", "metal", 0.0032, axis * 0.044, mount * 1.08, shape=_CYLINDER)
        visuals.bar("head", "trim", 0.0065, axis * 0.046, axis * 0.040 + _vector(0, 0, 0.012), top)
    visuals.primitive("head", "trim", _CYLINDER, (0.030, 0.006), top + _vector(0, 0, 0.004))


def _skull(visuals: VisualGeoms, height: float) -> None:
    cranium = superellipsoid((0.082, 0.074, 0.078), 0.82)
    visuals.mesh("head", "shell", "cranium", cranium, (0.0, 0.0, height + 0.016))
    jaw = superellipsoid((0.052, 0.050, 0.034), 0.75)
    visuals.mesh("head", "shell", "jaw", jaw, (0.024, 0.0, height - 0.052))
    for side in (1, -1):
        ear = np.array((-0.006, side * 0.072, height + 0.012))
        visuals.primitive("head", "trim", _CYLINDER, (0.023, 0.006), ear, (0, 1, 0))
        visuals.primitive("head", "rod", _CYLINDER, (0.016, 0.008), ear, (0, 1, 0))
        visuals.primitive("head", "trim", _CYLINDER, (0.007, 0.0095), ear, (0, 1, 0))
        visuals.primitive(
            "head", "cheek", _ELLIPSOID, (0.003, 0.011, 0.008), (0.068, side * 0.040, height - 0.030)
        )


def _face(visuals: VisualGeoms, robot: RobotData) -> None:
    height = robot.head.centre_height
    visor = superellipsoid((0.036, 0.063, 0.033), 0.6)
    visuals.mesh("head", "visor", "visor", visor, (0.054, 0.0, height + EYE_UP))
    for side in (1, -1):
        eye = np.array((0.081, side * robot.head.eye_baseline / 2, height + EYE_UP))
        visuals.primitive("head", "white", _SPHERE, (0.0215,), eye)
        visuals.primitive("head", "iris", _ELLIPSOID, (0.006, 0.0135, 0.0135), eye + _vector(0.0178, 0, 0))
        visuals.primitive("head", "black", _ELLIPSOID, (0.004, 0.0075, 0.0075), eye + _vector(0.0215, 0, 0))
        visuals.primitive("head", "white", _SPHERE, (0.0024,), eye + _vector(0.0232, 0.004, 0.0045))
        arch = [
            (0.013 - 12.0 * y * y, y, 0.029 - 22.0 * y * y) for y in np.linspace(-0.014, 0.014, 7).tolist()
        ]
        visuals.bar("head", "visor", 0.0024, *(eye + _vector(*point) for point in arch))
    smile = [
        (0.0745 - 6.0 * y * y, y, height - 0.060 + 9.0 * y * y)
        for y in np.linspace(-0.024, 0.024, 9).tolist()
    ]
    visuals.bar("head", "visor", 0.0024, *smile)
