"""The robot's shape for 3D views: simple solids on the bodies of the simulated neck, and the rotations of the bodies.

As in the MuJoCo model, every body's frame has its origin in the neck centre and is unrotated at home, so each body only
rotates. Names are those of the model.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from beatrix_zenoh.colours import ARMS, Colour
from beatrix_zenoh.contract._generated.messages import GeometryInfo
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData, HeadData
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import Rotation, Vector, cross, dot

Quaternion = tuple[float, float, float, float]
"""x, y, z, w"""

SHELL: Final = (237, 235, 227)
VISOR: Final = (33, 41, 51)
WHITE: Final = (252, 252, 250)
IRIS: Final = (26, 140, 158)
BLACK: Final = (8, 8, 10)
TRIM: Final = (76, 87, 99)
ROD: Final = (250, 199, 31)
METAL: Final = (168, 173, 179)
BASE: Final = (61, 69, 79)

# Lengths in m.
RING_RADIUS: Final = 0.046
RING_HEIGHT: Final = 0.013
POST_RADIUS: Final = 0.054
FLOOR: Final = -0.206
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


@dataclass(frozen=True)
class Body:
    """A body of the model; `path` consists of the names of its parents, from the root on, and its own name."""

    path: str
    solids: tuple[Solid, ...]


IDENTITY: Final[Quaternion] = (0.0, 0.0, 0.0, 1.0)


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


class Figure:
    """Bodies of one robot, and their rotations for arm angles and a head orientation."""

    def __init__(self, geometry: GeometryData = ROBOT.geometry, size: HeadData = ROBOT.head) -> None:
        """Create the bodies with the lengths of `size`; its masses are not used.

        With this geometry the neck must close upright (see Neck).
        """
        arm, rod, tilt = (
            math.radians(angle) for angle in (geometry.arm_angle, geometry.rod_twist, geometry.mount_angle)
        )
        ahead = math.acos((math.cos(rod) + math.cos(arm) * math.cos(tilt)) / (math.sin(arm) * math.sin(tilt)))
        self.azimuths = [
            math.radians(geometry.arm0_azimuth + index * geometry.arm_spacing) for index in range(3)
        ]
        self.elbows = [direction(azimuth, math.sin(arm), -math.cos(arm)) for azimuth in self.azimuths]
        """Elbow axes at home, unit vectors."""
        self.mounts = [
            direction(azimuth + geometry.hand * ahead, math.sin(tilt), math.cos(tilt))
            for azimuth in self.azimuths
        ]
        """Axes of the skull's mounts at home, unit vectors."""
        self.size = size
        self.bodies = (self._base(), *self._arms(), *self._rods(), self._head())

    def rotations(self, arms: Arms, head: Rotation) -> dict[str, Quaternion]:
        """Return the rotation of each moving body in its parent's frame, by path.

        Args:
            arms: angles from home (rad).
            head: rows of the head's orientation.
        """
        turns = {}
        for name, arm, elbow, mount in zip(ARMS, arms, self.elbows, self.mounts, strict=True):
            turns[f"arm_{name}"] = about((0.0, 0.0, 1.0), arm)
            turns[f"arm_{name}/rod_{name}"] = about(elbow, rod_angle(elbow, mount, arm, head))
        turns["head"] = quaternion(head)
        return turns

    def _base(self) -> Body:
        up = (0.0, 0.0, 1.0)
        solids = [
            cylinder((0.0, 0.0, FLOOR + 0.006), up, 0.085, 0.012, BASE),
            cylinder((0.0, 0.0, -0.124), up, 0.062, 0.006, BASE),
            *bar((0.0, 0.0, FLOOR), (0.0, 0.0, -0.058), 0.007, METAL),
        ]
        for azimuth in self.azimuths:
            foot, top = direction(azimuth, 0.070, FLOOR), direction(azimuth, 0.052, -0.124)
            solids += bar(foot, top, 0.005, TRIM)
            motor = direction(azimuth + math.pi / 3, 0.030, -0.152)
            solids.append(cylinder(motor, up, 0.019, 0.034, TRIM))
        return Body("base", tuple(solids))

    def _arms(self) -> list[Body]:
        reach, bodies = self.size.arm_length, []
        for index, (name, azimuth, elbow) in enumerate(zip(ARMS, self.azimuths, self.elbows, strict=True)):
            colour, height = ARMS[name], ring_height(index)
            solids = [
                cylinder((0.0, 0.0, height), (0.0, 0.0, 1.0), RING_RADIUS, RING_HEIGHT, colour),
                *bar(
                    direction(azimuth, RING_RADIUS, height),
                    direction(azimuth, POST_RADIUS, height),
                    0.0056,
                    colour,
                ),
                *bar(direction(azimuth, POST_RADIUS, height), scaled(elbow, reach * 1.27), 0.0056, colour),
                *bar(scaled(elbow, reach * 0.93), scaled(elbow, reach * 1.27), 0.0036, METAL),
            ]
            bodies.append(Body(f"arm_{name}", tuple(solids)))
        return bodies

    def _rods(self) -> list[Body]:
        reach, bodies = self.size.arm_length, []
        for name, elbow, mount in zip(ARMS, self.elbows, self.mounts, strict=True):
            points = [scaled(point, reach) for point in arc(elbow, mount, ROD_PARTS)]
            solids = [
                solid for start, end in itertools.pairwise(points) for solid in bar(start, end, 0.0055, ROD)
            ]
            solids.append(cylinder(points[0], elbow, 0.0085, 0.0075, ROD))
            solids.append(cylinder(points[-1], mount, 0.0085, 0.0075, ROD))
            bodies.append(Body(f"arm_{name}/rod_{name}", tuple(solids)))
        return bodies

    def _head(self) -> Body:
        height, eyes = self.size.centre_height, self.size.eye_baseline / 2
        top = (0.0, 0.0, 0.044)
        solids = [
            ellipsoid((0.0, 0.0, height + 0.016), (0.082, 0.074, 0.078), SHELL),
            ellipsoid((0.024, 0.0, height - 0.052), (0.052, 0.048, 0.032), SHELL),
            ellipsoid((0.050, 0.0, height + 0.018), (0.042, 0.063, 0.033), VISOR),
            cylinder(top, (0.0, 0.0, 1.0), 0.030, 0.012, TRIM),
        ]
        for mount in self.mounts:
            solids += bar(scaled(mount, 0.044), scaled(mount, self.size.mount_radius * 1.08), 0.0034, METAL)
            solids += bar(scaled(mount, 0.044), top, 0.0065, TRIM)
        for side in (1.0, -1.0):
            eye = (0.083, side * eyes, height + 0.018)
            solids += [
                ellipsoid(eye, (0.0215, 0.0215, 0.0215), WHITE),
                ellipsoid((eye[0] + 0.0178, eye[1], eye[2]), (0.006, 0.0135, 0.0135), IRIS),
                ellipsoid((eye[0] + 0.0215, eye[1], eye[2]), (0.004, 0.0075, 0.0075), BLACK),
                cylinder((-0.006, side * 0.072, height + 0.012), (0.0, 1.0, 0.0), 0.023, 0.012, TRIM),
                cylinder((-0.006, side * 0.075, height + 0.012), (0.0, 1.0, 0.0), 0.016, 0.012, ROD),
            ]
        smile = [
            (0.0745 - 6.0 * y * y, y, height - 0.060 + 9.0 * y * y)
            for y in (-0.024, -0.012, 0.0, 0.012, 0.024)
        ]
        for start, end in itertools.pairwise(smile):
            solids += bar(start, end, 0.0024, VISOR)
        return Body("head", tuple(solids))


def ring_height(index: int) -> float:
    """Return the height (m) of an arm's ring gear; the short arm's is on top."""
    return -0.068 - 0.019 * index


def direction(azimuth: float, across: float, up: float) -> Vector:
    """Return a vector from cylindrical coordinates: azimuth (rad), distance from the vertical axis and height (m)."""
    return across * math.cos(azimuth), across * math.sin(azimuth), up


def scaled(vector: Vector, length: float) -> Vector:
    """Return `length` times the vector."""
    return vector[0] * length, vector[1] * length, vector[2] * length


def rod_angle(elbow: Vector, mount: Vector, arm: float, head: Rotation) -> float:
    """Return the angle of a rod about its elbow (rad, 0 at home) that brings its end to the skull's mount.

    Args:
        elbow: elbow axis at home, unit vector.
        mount: mount axis at home, unit vector.
        arm: arm angle (rad).
        head: rows of the head's orientation.
    """
    turned = tuple(dot(row, mount) for row in head)
    c, s = math.cos(arm), math.sin(arm)
    seen = (c * turned[0] + s * turned[1], c * turned[1] - s * turned[0], turned[2])
    across = dot(elbow, cross(mount, seen))
    along = dot(mount, seen) - dot(elbow, mount) * dot(elbow, seen)
    return math.atan2(across, along)


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


def ellipsoid(position: Vector, half_axes: Vector, colour: Colour) -> Solid:
    """Return an ellipsoid whose axes are parallel to those of its body; lengths in m."""
    return Solid(Form.ELLIPSOID, half_axes, position, IDENTITY, colour)


def cylinder(position: Vector, axis: Vector, radius: float, length: float, colour: Colour) -> Solid:
    """Return a cylinder with its centre at `position` and its axis along the unit vector `axis`; lengths in m."""
    return Solid(Form.CYLINDER, (radius, length), position, towards(axis), colour)


def bar(start: Vector, end: Vector, radius: float, colour: Colour) -> list[Solid]:
    """Return a round bar between two points (m), as a list with one solid."""
    x, y, z = (e - s for s, e in zip(start, end, strict=True))
    length = math.sqrt(x * x + y * y + z * z)
    return [
        Solid(Form.CAPSULE, (radius, length), start, towards((x / length, y / length, z / length)), colour)
    ]
