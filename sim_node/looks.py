"""What the simulated robot looks like: shapes without mass or contact, lights and the observer's camera.

Own shapes, made to be read at a glance: the short arm is red, the middle one green, the long one blue, the
twisted rods are yellow; the face points along x.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh._generated.robot import RobotData
from sim_node.shapes import Shape, Vector, internal_gear, superellipsoid, twisted_rod

Point = Sequence[float] | Vector

ARMS: Final = ("short", "middle", "long")
VISUAL: Final = 2
"""Geom group of everything that is seen."""
COLLISION: Final = 3
"""Geom group of everything that has mass; hidden."""
RING_RADIUS: Final = 0.046
"""Of the ring gears (m)."""
RING_HEIGHT: Final = 0.013
POST_RADIUS: Final = 0.054
"""Distance of the arms' uprights from the axis (m)."""
EYE_FORWARD: Final = 0.107
"""Of the cameras, from the neck centre (m)."""
EYE_UP: Final = 0.018
"""Of the cameras, above the head's centre of mass (m)."""

SKY: Final = (0.93, 0.95, 0.97)
TILES: Final = ((0.88, 0.885, 0.875), (0.845, 0.855, 0.85))
TILE: Final = 0.1
"""Side of the floor's tiles (m)."""

_FLOOR: Final = -0.206
_SPHERE: Final = mujoco.mjtGeom.mjGEOM_SPHERE
_CAPSULE: Final = mujoco.mjtGeom.mjGEOM_CAPSULE
_ELLIPSOID: Final = mujoco.mjtGeom.mjGEOM_ELLIPSOID
_CYLINDER: Final = mujoco.mjtGeom.mjGEOM_CYLINDER
_BOX: Final = mujoco.mjtGeom.mjGEOM_BOX

_COLOURS: Final[dict[str, tuple[float, float, float]]] = {
    "shell": (0.93, 0.92, 0.89),
    "visor": (0.13, 0.16, 0.20),
    "white": (0.99, 0.99, 0.98),
    "iris": (0.10, 0.55, 0.62),
    "black": (0.03, 0.03, 0.04),
    "trim": (0.30, 0.34, 0.39),
    "cheek": (0.95, 0.62, 0.56),
    "rod": (0.98, 0.78, 0.12),
    "short": (0.86, 0.24, 0.21),
    "middle": (0.20, 0.65, 0.36),
    "long": (0.18, 0.42, 0.82),
    "metal": (0.66, 0.68, 0.70),
    "motor": (0.30, 0.31, 0.34),
    "base": (0.24, 0.27, 0.31),
}


def ring_height(index: int) -> float:
    """Height (m) of an arm's ring gear; the short arm's is on top."""
    return -0.068 - 0.019 * index


class Wardrobe:
    """Hangs visual geoms on the bodies of a model; materials and meshes are made as needed."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        for name, colour in _COLOURS.items():
            glossy = name in {"visor", "white", "iris", "black"}
            spec.add_material(
                name=name,
                rgba=[*colour, 1.0],
                specular=0.8 if glossy else 0.25,
                shininess=0.9 if glossy else 0.4,
            )

    def put(
        self,
        body: str,
        material: str,
        shape: mujoco.mjtGeom,
        size: Sequence[float],
        pos: Point = (0.0, 0.0, 0.0),
        axis: Point = (0.0, 0.0, 1.0),
    ) -> None:
        """A primitive (m) at `pos` of a body, its z axis along `axis`."""
        self._geom(body, material, type=shape, size=[*size, 0.0, 0.0][:3], pos=list(pos), zaxis=list(axis))

    def bar(
        self,
        body: str,
        material: str,
        radius: float,
        *points: Point,
        shape: mujoco.mjtGeom = _CAPSULE,
    ) -> None:
        """A round bar of this radius (m) through points."""
        for start, end in itertools.pairwise(points):
            self._geom(body, material, type=shape, size=[radius, 0.0, 0.0], fromto=[*start, *end])

    def mesh(self, body: str, material: str, name: str, shape: Shape, pos: Point = (0.0, 0.0, 0.0)) -> None:
        """A shape of our own, once defined under its name and then used again."""
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


def dress(spec: mujoco.MjSpec, robot: RobotData) -> None:
    """Adds everything that is seen to a model whose bodies are there."""
    wardrobe = Wardrobe(spec)
    _stage(spec)
    _base(wardrobe, robot)
    for index, name in enumerate(ARMS):
        _chain(spec, wardrobe, robot, index, name)
    _neck(spec, wardrobe)
    _skull(wardrobe, robot.head.centre_height)
    _face(wardrobe, robot)


def _stage(spec: mujoco.MjSpec) -> None:
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
        pos=[0, 0, _FLOOR],
        material="floor",
        group=VISUAL,
    )
    plane.contype = plane.conaffinity = 0
    sun = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    world.add_light(type=sun, pos=[0.6, -0.5, 1.2], dir=[-0.5, 0.55, -1.1], diffuse=[0.60, 0.59, 0.56])
    fill = world.add_light(type=sun, pos=[1.0, -1.2, 0.6], dir=[-0.8, 1.0, -0.5], diffuse=[0.20, 0.21, 0.23])
    fill.castshadow = False
    _observer(world)
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


def _observer(world: mujoco.MjsBody) -> None:
    place, target = np.array((0.80, -0.56, 0.20)), np.array((0.0, 0.0, 0.012))
    ahead = (target - place) / np.linalg.norm(target - place)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    world.add_camera(name="observer", pos=place, xyaxes=[*right, *np.cross(right, ahead)], fovy=28.0)


def _base(wardrobe: Wardrobe, robot: RobotData) -> None:
    wardrobe.put("world", "base", _CYLINDER, (0.085, 0.006), (0, 0, _FLOOR + 0.006))
    wardrobe.put("world", "trim", _CYLINDER, (0.088, 0.003), (0, 0, _FLOOR + 0.003))
    wardrobe.put("world", "base", _CYLINDER, (0.062, 0.003), (0, 0, -0.124))
    wardrobe.bar("world", "metal", 0.007, (0, 0, -0.124), (0, 0, -0.058))
    module = RING_RADIUS * 0.88 * 2 / robot.drive.gear_ring
    for index in range(3):
        azimuth = math.radians(robot.geometry.arm0_azimuth + 60.0 + 120.0 * index)
        away = np.array((math.cos(azimuth), math.sin(azimuth), 0.0))
        at = away * module * (robot.drive.gear_ring - robot.drive.gear_pinion) / 2
        wardrobe.put("world", "motor", _BOX, (0.021, 0.021, 0.017), at + _vector(0, 0, -0.150), (0, 0, 1))
        wardrobe.put("world", "metal", _BOX, (0.0212, 0.0212, 0.005), at + _vector(0, 0, -0.132), (0, 0, 1))
        height = ring_height(index)
        wardrobe.bar("world", "metal", 0.0025, at + _vector(0, 0, -0.13), at + _vector(0, 0, height))
        pinion = module * robot.drive.gear_pinion / 2
        wardrobe.put("world", "metal", _CYLINDER, (pinion, RING_HEIGHT / 2), at + _vector(0, 0, height))
        post = away * -0.075
        wardrobe.bar(
            "world", "trim", 0.005, post + _vector(0, 0, _FLOOR), post * 0.75 + _vector(0, 0, -0.124)
        )


def _chain(spec: mujoco.MjSpec, wardrobe: Wardrobe, robot: RobotData, index: int, name: str) -> None:
    elbow = np.array(spec.joint(f"rod_{name}").axis)
    mount = np.array(spec.site(f"rod_{name}").pos)
    out = np.array((elbow[0], elbow[1], 0.0)) / np.hypot(elbow[0], elbow[1])
    height = np.array((0.0, 0.0, ring_height(index)))
    reach = robot.head.arm_length
    gear = internal_gear(RING_RADIUS, RING_RADIUS * 0.88, RING_HEIGHT, robot.drive.gear_ring)
    wardrobe.mesh(f"arm_{name}", name, "ring", gear, height)
    post = out * POST_RADIUS
    wardrobe.bar(
        f"arm_{name}",
        name,
        0.0052,
        out * RING_RADIUS + height,
        post + height,
        elbow * reach * 1.27,
        elbow * reach * 1.1,
    )
    wardrobe.bar(f"arm_{name}", "metal", 0.0032, elbow * reach * 0.93, elbow * reach * 1.27, shape=_CYLINDER)
    rod = twisted_rod(elbow, mount / np.linalg.norm(mount), reach, 0.014, 0.0065)
    wardrobe.mesh(f"rod_{name}", "rod", f"rod_{name}", rod)
    for axis, length in ((elbow, reach), (mount / np.linalg.norm(mount), robot.head.mount_radius)):
        wardrobe.put(f"rod_{name}", "rod", _CYLINDER, (0.0085, 0.0036), axis * length, axis)


def _neck(spec: mujoco.MjSpec, wardrobe: Wardrobe) -> None:
    """Hub and three spokes that carry the skull on the rods' ends."""
    top = np.array((0.0, 0.0, 0.040))
    for name in ARMS:
        mount = np.array(spec.site(f"mount_{name}").pos)
        axis = mount / np.linalg.norm(mount)
        wardrobe.bar("head", "metal", 0.0032, axis * 0.044, mount * 1.08, shape=_CYLINDER)
        wardrobe.bar("head", "trim", 0.0065, axis * 0.046, axis * 0.040 + _vector(0, 0, 0.012), top)
    wardrobe.put("head", "trim", _CYLINDER, (0.030, 0.006), top + _vector(0, 0, 0.004))


def _skull(wardrobe: Wardrobe, height: float) -> None:
    cranium = superellipsoid((0.082, 0.074, 0.078), 0.82)
    wardrobe.mesh("head", "shell", "cranium", cranium, (0.0, 0.0, height + 0.016))
    jaw = superellipsoid((0.052, 0.050, 0.034), 0.75)
    wardrobe.mesh("head", "shell", "jaw", jaw, (0.024, 0.0, height - 0.052))
    for side in (1, -1):
        ear = np.array((-0.006, side * 0.072, height + 0.012))
        wardrobe.put("head", "trim", _CYLINDER, (0.023, 0.006), ear, (0, 1, 0))
        wardrobe.put("head", "rod", _CYLINDER, (0.016, 0.008), ear, (0, 1, 0))
        wardrobe.put("head", "trim", _CYLINDER, (0.007, 0.0095), ear, (0, 1, 0))
        wardrobe.put(
            "head", "cheek", _ELLIPSOID, (0.003, 0.011, 0.008), (0.068, side * 0.040, height - 0.030)
        )


def _face(wardrobe: Wardrobe, robot: RobotData) -> None:
    height = robot.head.centre_height
    visor = superellipsoid((0.036, 0.063, 0.033), 0.6)
    wardrobe.mesh("head", "visor", "visor", visor, (0.054, 0.0, height + EYE_UP))
    for side in (1, -1):
        eye = np.array((0.081, side * robot.head.eye_baseline / 2, height + EYE_UP))
        wardrobe.put("head", "white", _SPHERE, (0.0215,), eye)
        wardrobe.put("head", "iris", _ELLIPSOID, (0.006, 0.0135, 0.0135), eye + _vector(0.0178, 0, 0))
        wardrobe.put("head", "black", _ELLIPSOID, (0.004, 0.0075, 0.0075), eye + _vector(0.0215, 0, 0))
        wardrobe.put("head", "white", _SPHERE, (0.0024,), eye + _vector(0.0232, 0.004, 0.0045))
        arch = [
            (0.013 - 12.0 * y * y, y, 0.029 - 22.0 * y * y) for y in np.linspace(-0.014, 0.014, 7).tolist()
        ]
        wardrobe.bar("head", "visor", 0.0024, *(eye + _vector(*point) for point in arch))
    smile = [
        (0.0745 - 6.0 * y * y, y, height - 0.060 + 9.0 * y * y)
        for y in np.linspace(-0.024, 0.024, 9).tolist()
    ]
    wardrobe.bar("head", "visor", 0.0024, *smile)
