"""The bodies of the robot in pictures: their rotations, their meshes, and the mechanism inside, which viewers hide at first.

As in the MuJoCo model, every body's frame has its origin in the neck centre and is unrotated at home, so each body only
rotates. Names are those of the model. Each arm's motor, ring, link and axes of the mechanism have the arm's colour.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.head_shape import AWAKE, Face, add_head
from beatrix_zenoh.body.surface import INNER, Mesh, Modeller
from beatrix_zenoh.colours import ARMS, Colour
from beatrix_zenoh.contract._generated.messages import GeometryInfo
from beatrix_zenoh.contract._generated.robot import COLOURS, ROBOT, SIZES, GeometryData, HeadData
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import Rotation, Vector, cross, dot

Quaternion = tuple[float, float, float, float]
"""x, y, z, w"""
Floats = npt.NDArray[np.float64]


def geometry_of(info: GeometryInfo) -> GeometryData:
    """Convert the geometry that a robot reports (rad) to that of robot data (deg)."""
    return GeometryData(
        arm_angle=math.degrees(info.arm_angle),
        rod_twist=math.degrees(info.rod_twist),
        mount_angle=math.degrees(info.mount_angle),
        hand=info.hand,
        arm0_azimuth=math.degrees(info.arm0_azimuth),
        arm_spacing=math.degrees(info.arm_spacing),
    )


class Chain(NamedTuple):
    """One arm and its rod at home: unit vectors from the neck centre."""

    azimuth: float
    """of the arm (rad)"""
    elbow: Vector
    """axis of the rod's hinge on the arm"""
    mount: Vector
    """axis of the rod's hinge on the skull"""

    def rod_angle(self, arm: float, head: Rotation) -> float:
        """Return the angle of the rod about its elbow (rad, 0 at home) that brings its end to the skull's mount.

        Args:
            arm: arm angle (rad).
            head: rows of the head's orientation.
        """
        elbow, mount = self.elbow, self.mount
        turned = tuple(dot(row, mount) for row in head)
        c, s = math.cos(arm), math.sin(arm)
        seen = (c * turned[0] + s * turned[1], c * turned[1] - s * turned[0], turned[2])
        across = dot(elbow, cross(mount, seen))
        along = dot(mount, seen) - dot(elbow, mount) * dot(elbow, seen)
        return math.atan2(across, along)


def chains(geometry: GeometryData) -> list[Chain]:
    """Return the chains of the short, middle and long arm; the neck must close upright (see Neck)."""
    arm, rod, tilt = map(math.radians, (geometry.arm_angle, geometry.rod_twist, geometry.mount_angle))
    # This follows from elbow . mount = cos(rod twist) at home.
    ahead = math.acos((math.cos(rod) + math.cos(arm) * math.cos(tilt)) / (math.sin(arm) * math.sin(tilt)))
    azimuths = [math.radians(geometry.arm0_azimuth + index * geometry.arm_spacing) for index in range(3)]
    return [
        Chain(
            azimuth,
            direction(azimuth, math.sin(arm), -math.cos(arm)),
            direction(azimuth + geometry.hand * ahead, math.sin(tilt), math.cos(tilt)),
        )
        for azimuth in azimuths
    ]


class Figure:
    """Bodies of one robot, and their rotations for arm angles and a head orientation."""

    paths: Final = (
        "base",
        *(f"arm_{name}" for name in ARMS),
        *(f"arm_{name}/rod_{name}" for name in ARMS),
        "head",
    )
    """Of all bodies: the names of a body's parents, from the root on, and its own name."""

    def __init__(self, geometry: GeometryData = ROBOT.geometry, size: HeadData = ROBOT.head) -> None:
        """Create the bodies with the lengths of `size`; its masses are not used."""
        self.chains = chains(geometry)
        self.size = size

    def rotations(self, arms: Arms, head: Rotation) -> dict[str, Quaternion]:
        """Return the rotation of each moving body in its parent's frame, by path.

        Args:
            arms: angles from home (rad).
            head: rows of the head's orientation.
        """
        turns = {}
        for name, arm, chain in zip(ARMS, arms, self.chains, strict=True):
            turns[f"arm_{name}"] = about((0.0, 0.0, 1.0), arm)
            turns[f"arm_{name}/rod_{name}"] = about(chain.elbow, chain.rod_angle(arm, head))
        turns["head"] = quaternion(head)
        return turns

    def orientations(self, arms: Arms, head: Rotation) -> dict[str, Floats]:
        """Return the rotation matrix of each body from its frame to that of the base, by its path.

        Args:
            arms: angles from home (rad).
            head: rows of the head's orientation.
        """
        found = {"base": np.eye(3)}
        for path, quaternion in self.rotations(arms, head).items():
            parent, _, _ = path.rpartition("/")
            found[path] = found[parent or "base"] @ matrix(quaternion)
        return found


def direction(azimuth: float, across: float, up: float) -> Vector:
    """Return a vector from cylindrical coordinates: azimuth (rad), distance from the vertical axis and height (m)."""
    return across * math.cos(azimuth), across * math.sin(azimuth), up


def scaled(vector: Vector, length: float) -> Vector:
    """Return `length` times the vector."""
    return vector[0] * length, vector[1] * length, vector[2] * length


def about(axis: Vector, angle: float) -> Quaternion:
    """Return the rotation about a unit vector by an angle (rad)."""
    s = math.sin(angle / 2)
    return axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2)


def quaternion(rotation: Rotation) -> Quaternion:
    """Return the quaternion of a rotation given by its rows."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    rows = (  # each is a multiple of the quaternion; the one with the largest number on the diagonal is the most exact
        (1 + a - e - i, b + d, c + g, h - f),
        (b + d, 1 - a + e - i, f + h, c - g),
        (c + g, f + h, 1 - a - e + i, d - b),
        (h - f, c - g, d - b, 1 + a + e + i),
    )
    x, y, z, w = rows[max(range(4), key=lambda index: rows[index][index])]
    k = 1 / math.sqrt(x * x + y * y + z * z + w * w)
    return x * k, y * k, z * k, w * k


def matrix(turn: Quaternion) -> Floats:
    """Return the rotation matrix of a quaternion."""
    x, y, z, w = turn
    return np.array((
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    ))  # fmt: skip


# Lengths in m.
UP: Final[Vector] = (0.0, 0.0, 1.0)
CENTRE: Final[Vector] = (0.0, 0.0, 0.0)
PLATE: Final = -0.124
"""Height of the plate that carries the mast."""
MOTOR: Final = -0.150
"""Height of the motors' middles."""
AXIS_RADIUS: Final = 0.0016
AXIS_LENGTH: Final = 0.105
"""Length of the elbows' and mounts' axes, from the neck centre on."""
HEAD_AXIS: Final = 0.24
LINK_RADIUS: Final = 0.0042


@lru_cache(maxsize=64)
def meshes(figure: Figure, *, fine: bool = False, face: Face = AWAKE) -> tuple[Mesh, ...]:
    """Return the mesh of each body; see `Modeller` for `fine`."""
    model = Modeller(fine=fine)
    add_head(model, figure.size, [chain.mount for chain in figure.chains], face)
    return *_below(figure, fine=fine), *model.meshes()


@lru_cache(maxsize=16)
def _below(figure: Figure, *, fine: bool) -> tuple[Mesh, ...]:
    """Return the meshes of the bodies below the head."""
    model = Modeller(fine=fine)
    _base(model, figure)
    for index, (name, colour) in enumerate(ARMS.items()):
        _chain(model, figure, index, name, colour)
    return model.meshes()


@lru_cache(maxsize=8)
def mechanism(figure: Figure, *, fine: bool = False) -> tuple[Mesh, ...]:
    """Return the meshes of the mechanism inside each body; see `Modeller` for `fine`."""
    model = Modeller(fine=fine)
    model.tube("base", [(0.0, 0.0, SIZES.floor), CENTRE], AXIS_RADIUS * 1.5, COLOURS.black)
    model.ellipsoid("head", CENTRE, (0.007, 0.007, 0.007), COLOURS.black)
    model.tube("head", [CENTRE, (0.0, 0.0, HEAD_AXIS)], AXIS_RADIUS, COLOURS.black)
    for index, (name, colour) in enumerate(ARMS.items()):
        azimuth, elbow, mount = figure.chains[index]
        reach, radius = figure.size.arm_length, figure.size.mount_radius
        height, arm, rod = SIZES.ring_heights[index], f"arm_{name}", f"arm_{name}/rod_{name}"
        motor, pinion = (motor_at(azimuth, up) for up in (MOTOR, height))
        model.cylinder("base", motor, UP, (0.019, 0.034), colour)
        model.tube("base", [motor, pinion], 0.003, colour)
        model.cylinder("base", pinion, UP, (0.0155, 0.006), colour)
        ring, post = (0.0, 0.0, height), direction(azimuth, SIZES.post_radius, height)
        model.cylinder(arm, ring, UP, (SIZES.ring_radius, 0.003), colour)
        model.tube(arm, [ring, post, scaled(elbow, reach)], LINK_RADIUS, colour)
        model.rod(rod, (elbow, mount), reach, (2 * LINK_RADIUS, 2 * LINK_RADIUS), COLOURS.rod)
        model.tube("head", [scaled(mount, radius), (0.0, 0.0, radius)], LINK_RADIUS, COLOURS.black)
        for body, axis, distance in ((arm, elbow, reach), (rod, mount, radius)):
            model.cylinder(body, scaled(axis, distance), axis, (0.0095, 0.013), colour)
            model.tube(body, [CENTRE, scaled(axis, AXIS_LENGTH)], AXIS_RADIUS, colour)
    return model.meshes()


def motor_at(azimuth: float, height: float) -> Vector:
    """Return a point on the axis of the motor whose pinion drives the arm of this azimuth (rad)."""
    drive = ROBOT.drive
    away = SIZES.ring_radius * INNER * (1.0 - drive.gear_pinion / drive.gear_ring)
    return direction(azimuth + math.pi / 3, away, height)


def _base(model: Modeller, figure: Figure) -> None:
    model.cylinder("base", (0.0, 0.0, SIZES.floor + 0.006), UP, (0.085, 0.012), COLOURS.base)
    model.cylinder("base", (0.0, 0.0, SIZES.floor + 0.003), UP, (0.088, 0.006), COLOURS.trim)
    model.cylinder("base", (0.0, 0.0, PLATE), UP, (0.062, 0.006), COLOURS.base)
    drive = ROBOT.drive
    pinion = SIZES.ring_radius * INNER * drive.gear_pinion / drive.gear_ring
    for (azimuth, _, _), height in zip(figure.chains, SIZES.ring_heights, strict=True):
        foot, top = direction(azimuth, 0.075, SIZES.floor), direction(azimuth, 0.05625, PLATE)
        model.tube("base", [foot, top], 0.005, COLOURS.trim)
        box = 0.021 * math.sqrt(2)
        model.cylinder("base", motor_at(azimuth, MOTOR), UP, (box, 0.034), COLOURS.motor, box=True)
        if model.fine:
            flange = box * 1.01, 0.010
            model.cylinder("base", motor_at(azimuth, -0.132), UP, flange, COLOURS.metal, box=True)
            shaft = [motor_at(azimuth, -0.13), motor_at(azimuth, height)]
            model.tube("base", shaft, 0.0025, COLOURS.metal)
            size = pinion, SIZES.ring_thickness
            model.cylinder("base", motor_at(azimuth, height), UP, size, COLOURS.metal)
    if model.fine:
        model.tube("base", [(0.0, 0.0, PLATE), (0.0, 0.0, -0.058)], 0.007, COLOURS.metal)


def _chain(model: Modeller, figure: Figure, index: int, name: str, colour: Colour) -> None:
    arm, rod, reach = f"arm_{name}", f"arm_{name}/rod_{name}", figure.size.arm_length
    (azimuth, elbow, mount), height = figure.chains[index], SIZES.ring_heights[index]
    model.gear(arm, height, (SIZES.ring_radius, SIZES.ring_thickness), ROBOT.drive.gear_ring, colour)
    link = (
        direction(azimuth, SIZES.ring_radius, height),
        direction(azimuth, SIZES.post_radius, height),
        scaled(elbow, reach * 1.27),
        scaled(elbow, reach * 1.1),
    )
    model.tube(arm, link, 0.0052, colour)
    model.cylinder(arm, scaled(elbow, reach * 1.1), elbow, (0.0032, reach * 0.34), COLOURS.metal)
    model.rod(rod, (elbow, mount), reach, (0.014, 0.0065), COLOURS.rod)
    for axis, length in ((elbow, reach), (mount, figure.size.mount_radius)):
        model.cylinder(rod, scaled(axis, length), axis, (0.0085, 0.0072), COLOURS.rod)
