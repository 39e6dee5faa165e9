"""The bodies of the robot in pictures, and their rotations.

As in the MuJoCo model, every body's frame has its origin in the neck centre and is unrotated at home, so each body only
rotates. Names are those of the model.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.colours import ARMS
from beatrix_zenoh.contract._generated.messages import GeometryInfo
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData, HeadData
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


def matrix(turn: Quaternion) -> Floats:
    """Return the rotation matrix of a quaternion."""
    x, y, z, w = turn
    return np.array((
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    ))  # fmt: skip
