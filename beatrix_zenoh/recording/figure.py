"""The robot's shape for 3D views: simple solids on the bodies of the simulated neck, and the rotations of the bodies.

As in the MuJoCo model, every body's frame has its origin in the neck centre and is unrotated at home, so each body only
rotates. Names are those of the model.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final, NamedTuple

from beatrix_zenoh.colours import ARMS, Colour
from beatrix_zenoh.contract._generated.messages import GeometryInfo
from beatrix_zenoh.contract._generated.robot import COLOURS, ROBOT, SIZES, GeometryData, HeadData
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import Rotation, Vector, cross, dot

Quaternion = tuple[float, float, float, float]
"""x, y, z, w"""

ROD_PARTS: Final = 6
"""Number of straight pieces that form the arc of a rod."""


class Form(StrEnum):
    """The form of a solid; the text below each form describes the numbers (m) in `Solid.size`."""

    ELLIPSOID = "ellipsoid"
    """half axes"""
    CYLINDER = "cylinder"
    """radius, length; centred"""
    CAPSULE = "capsule"
    """radius, length of the straight part; begins at the position"""


@dataclass(frozen=True)
class Solid:
    """One solid on a body, in the body's frame."""

    form: Form
    size: tuple[float, ...]
    position: Vector
    quaternion: Quaternion
    colour: Colour
    mesh: bool = False
    """whether the simulation has a mesh in its place"""
    roundness: float = 1.0
    """of an ellipsoid in the simulation: towards 0 it becomes a box"""


@dataclass(frozen=True)
class Body:
    """A body of the model; `path` consists of the names of its parents, from the root on, and its own name."""

    path: str
    solids: tuple[Solid, ...]


IDENTITY: Final[Quaternion] = (0.0, 0.0, 0.0, 1.0)
UP: Final[Vector] = (0.0, 0.0, 1.0)


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

    def __init__(self, geometry: GeometryData = ROBOT.geometry, size: HeadData = ROBOT.head) -> None:
        """Create the bodies with the lengths of `size`; its masses are not used."""
        self.chains = chains(geometry)
        self.size = size
        self.bodies = (self._base(), *self._arms(), *self._rods(), self._head())

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

    def _base(self) -> Body:
        plate = -0.124
        solids = [
            cylinder((0.0, 0.0, SIZES.floor + 0.006), UP, 0.085, 0.012, COLOURS.base),
            cylinder((0.0, 0.0, SIZES.floor + 0.003), UP, 0.088, 0.006, COLOURS.trim),
            cylinder((0.0, 0.0, plate), UP, 0.062, 0.006, COLOURS.base),
            *bar([(0.0, 0.0, plate), (0.0, 0.0, -0.058)], 0.007, COLOURS.metal),
        ]
        for azimuth, _, _ in self.chains:
            foot, top = direction(azimuth, 0.075, SIZES.floor), direction(azimuth, 0.05625, plate)
            solids += bar([foot, top], 0.005, COLOURS.trim)
            motor = direction(azimuth + math.pi / 3, 0.030, -0.152)
            solids.append(replace(cylinder(motor, UP, 0.019, 0.034, COLOURS.motor), mesh=True))
        return Body("base", tuple(solids))

    def _arms(self) -> list[Body]:
        reach, bodies = self.size.arm_length, []
        for (name, colour), (azimuth, elbow, _), height in zip(
            ARMS.items(), self.chains, SIZES.ring_heights, strict=True
        ):
            ring = cylinder((0.0, 0.0, height), UP, SIZES.ring_radius, SIZES.ring_thickness, colour)
            pin = cylinder(scaled(elbow, reach * 1.1), elbow, 0.0032, reach * 0.34, COLOURS.metal)
            link = (
                direction(azimuth, SIZES.ring_radius, height),
                direction(azimuth, SIZES.post_radius, height),
                scaled(elbow, reach * 1.27),
                scaled(elbow, reach * 1.1),
            )
            bodies.append(Body(f"arm_{name}", (replace(ring, mesh=True), *bar(link, 0.0052, colour), pin)))
        return bodies

    def _rods(self) -> list[Body]:
        reach, bodies = self.size.arm_length, []
        for name, (_, elbow, mount) in zip(ARMS, self.chains, strict=True):
            points = [scaled(point, reach) for point in arc(elbow, mount, ROD_PARTS)]
            solids = [replace(solid, mesh=True) for solid in bar(points, 0.0055, COLOURS.rod)]
            for axis, length in ((elbow, reach), (mount, self.size.mount_radius)):
                solids.append(cylinder(scaled(axis, length), axis, 0.0085, 0.0072, COLOURS.rod))
            bodies.append(Body(f"arm_{name}/rod_{name}", tuple(solids)))
        return bodies

    def _head(self) -> Body:
        height, radius, top = self.size.centre_height, self.size.mount_radius, (0.0, 0.0, 0.040)
        visor = (0.054, 0.0, height + SIZES.eye_up)
        solids = [
            ellipsoid((0.0, 0.0, height + 0.016), (0.082, 0.074, 0.078), COLOURS.shell, 0.82),
            ellipsoid((0.024, 0.0, height - 0.052), (0.052, 0.050, 0.034), COLOURS.shell, 0.75),
            ellipsoid(visor, (0.036, 0.063, 0.033), COLOURS.visor, 0.6),
            cylinder((0.0, 0.0, 0.044), UP, 0.030, 0.012, COLOURS.trim),
        ]
        for _, _, mount in self.chains:
            begin, end = 0.044, radius * 1.08
            spoke = scaled(mount, (begin + end) / 2)
            solids.append(cylinder(spoke, mount, 0.0032, end - begin, COLOURS.metal))
            x, y, z = scaled(mount, 0.040)
            solids += bar([scaled(mount, 0.046), (x, y, z + 0.012), top], 0.0065, COLOURS.trim)
        for side in (1.0, -1.0):
            solids += self._side(side)
        smile = [
            (0.0745 - 6.0 * y * y, y, height - 0.060 + 9.0 * y * y) for y in (k * 0.006 for k in range(-4, 5))
        ]
        return Body("head", (*solids, *bar(smile, 0.0024, COLOURS.visor)))

    def _side(self, side: float) -> list[Solid]:
        """Return eye and ear of a side of the head: 1 is left, -1 right."""
        height = self.size.centre_height
        x, y, z = eye = (0.081, side * self.size.eye_baseline / 2, height + SIZES.eye_up)
        ear, out = (-0.006, side * 0.072, height + 0.012), (0.0, 1.0, 0.0)
        return [
            ellipsoid(eye, (0.0215, 0.0215, 0.0215), COLOURS.white),
            ellipsoid((x + 0.0178, y, z), (0.006, 0.0135, 0.0135), COLOURS.iris),
            ellipsoid((x + 0.0215, y, z), (0.004, 0.0075, 0.0075), COLOURS.black),
            ellipsoid((x + 0.0232, y + 0.004, z + 0.0045), (0.0024, 0.0024, 0.0024), COLOURS.white),
            cylinder(ear, out, 0.023, 0.012, COLOURS.trim),
            cylinder(ear, out, 0.016, 0.016, COLOURS.rod),
            cylinder(ear, out, 0.007, 0.019, COLOURS.trim),
        ]


def face_details(size: HeadData = ROBOT.head) -> list[Solid]:
    """Return eyebrows and cheeks, on the body `head`: for pictures that are large enough to show them."""
    solids, z = [], size.centre_height + SIZES.eye_up
    for side in (1, -1):
        middle = side * size.eye_baseline / 2
        arch = []
        for step in range(7):
            y = (step / 3 - 1) * 0.014
            arch.append((0.094 - 12.0 * y * y, middle + y, z + 0.029 - 22.0 * y * y))
        cheek = (0.068, side * 0.040, size.centre_height - 0.030)
        solids += [*bar(arch, 0.0024, COLOURS.visor), ellipsoid(cheek, (0.003, 0.011, 0.008), COLOURS.cheek)]
    return solids


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
    squares = (1 + a - e - i, 1 - a + e - i, 1 - a - e + i, 1 + a + e + i)
    largest = max(range(4), key=lambda index: squares[index])
    if largest == 0:
        parts = (squares[0], b + d, c + g, h - f)
    elif largest == 1:
        parts = (b + d, squares[1], f + h, c - g)
    elif largest == 2:
        parts = (c + g, f + h, squares[2], d - b)
    else:
        parts = (h - f, c - g, d - b, squares[3])
    x, y, z, w = parts
    k = 1 / math.sqrt(x * x + y * y + z * z + w * w)
    return x * k, y * k, z * k, w * k


def towards(axis: Vector) -> Quaternion:
    """Return the shortest rotation that turns the z axis to a unit vector."""
    x, y, z = axis
    if z < -0.999999:
        return 1.0, 0.0, 0.0, 0.0
    k = 1 / math.sqrt(2 + 2 * z)
    return -y * k, x * k, 0.0, (1 + z) * k


def arc(start: Vector, end: Vector, parts: int) -> list[Vector]:
    """Return `parts` + 1 points on the great circle between two unit vectors, both included."""
    angle = math.acos(max(-1.0, min(1.0, dot(start, end))))
    points = []
    for index in range(parts + 1):
        a, b = math.sin((1 - index / parts) * angle), math.sin(index / parts * angle)
        x, y, z = ((a * s + b * e) / math.sin(angle) for s, e in zip(start, end, strict=True))
        points.append((x, y, z))
    return points


def ellipsoid(position: Vector, half_axes: Vector, colour: Colour, roundness: float = 1.0) -> Solid:
    """Return an ellipsoid whose axes are parallel to those of its body; lengths in m."""
    return Solid(Form.ELLIPSOID, half_axes, position, IDENTITY, colour, roundness=roundness)


def cylinder(position: Vector, axis: Vector, radius: float, length: float, colour: Colour) -> Solid:
    """Return a cylinder with its centre at `position` and its axis along the unit vector `axis`; lengths in m."""
    return Solid(Form.CYLINDER, (radius, length), position, towards(axis), colour)


def bar(points: Sequence[Vector], radius: float, colour: Colour) -> list[Solid]:
    """Return a round bar through points (m): a capsule for each straight piece."""
    solids = []
    for start, end in itertools.pairwise(points):
        x, y, z = (e - s for s, e in zip(start, end, strict=True))
        length = math.sqrt(x * x + y * y + z * z)
        turn = towards((x / length, y / length, z / length))
        solids.append(Solid(Form.CAPSULE, (radius, length), start, turn, colour))
    return solids
