"""Kinematics of the neck: a coaxial 3-RRR spherical parallel mechanism.

Frames: x forward, y left, z up, origin in the neck centre; the head's frame is the base frame at home. Arm i has
the azimuth a_i and the skull mount axis m_i at home; t_i is its angle from home, counter-clockwise seen from above. R
is the head orientation, alpha1 = arm_angle, alpha2 = rod_twist, and s1, c1 = sin, cos of alpha1. Elbow axis and skull
mount axis of arm i are the unit vectors

    w_i = Rz(a_i + t_i) (s1, 0, -c1)          v_i = R m_i

and every rod keeps w_i . v_i = cos(alpha2): three closures for three degrees of freedom. All formulas here are derived
from these closures. The code uses plain Python floats, which for 3x3 matrices are ten times as fast as arrays.

Turning all three arms by the same angle turns the head by that angle and nothing else. Inverse and forward kinematics
are therefore solved without this common turn, which is added afterwards: angles stay continuous through any number of
turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from beatrix_zenoh.contract._generated.messages import Detail, Limit, Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData
from beatrix_zenoh.contract.errors import BeatrixError, Refused, bad_value
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.rotation import (
    Rotation,
    Triple,
    cross,
    dot,
    inverse_of_columns,
    tilt_of,
    turned,
    ypr_of,
)

_MAX_ITERATIONS: Final = 8
_MAX_TURN: Final = 0.5
"""Limit of a Newton step (rad): longer ones may leave the home assembly."""
_CONVERGED: Final = 1e-12
"""Square of the last Newton step (rad2): convergence is quadratic, so the remaining error is below 1e-11 rad."""


class HeadDerivatives(NamedTuple):
    """Yaw and tilt for given arms, and their derivatives."""

    yaw: float
    """rad, continuous"""
    up: float
    """cosine of the tilt"""
    yaw_by_arm: Arms
    """derivative of yaw by each arm; sums to 1"""
    up_by_arm: Arms
    """derivative of up by each arm (1/rad); sums to 0"""


class _Linear(NamedTuple):
    """The closures, linearised at one attitude."""

    error: Arms
    """w_i . v_i - cos(alpha2)"""
    normal_z: Arms
    """z of n_i = v_i x w_i"""
    det: float
    """n_0 . (n_1 x n_2)"""
    inverse: Triple
    """columns of the inverse of the matrix with rows n_i"""


class _Solution(NamedTuple):
    mean: float
    """mean angle of the arms (rad): the common turn of arms and head"""
    mounts: Triple
    """v_i without the common turn"""
    linear: _Linear


class Neck:
    """Inverse and forward kinematics of one geometry."""

    def __init__(self, geometry: GeometryData = ROBOT.geometry) -> None:
        """Raise Refused (BAD_VALUE) for a wrong `hand`, or a neck that does not close upright or cannot move there."""
        a1, a2, b = (math.radians(x) for x in (geometry.arm_angle, geometry.rod_twist, geometry.mount_angle))
        if geometry.hand not in {-1, 1}:
            raise bad_value(f"Hand is {geometry.hand}; it must be +1 or -1.")
        self.geometry = geometry
        self._hand = geometry.hand
        self._s1, self._c1, self._c2 = math.sin(a1), math.cos(a1), math.cos(a2)
        spacing = math.radians(geometry.arm_spacing)
        first = math.radians(geometry.arm0_azimuth)
        self._azimuth: Arms = (first, first + spacing, first + 2 * spacing)
        self._spacing = abs(spacing)
        self._order = math.copysign(1.0, spacing)
        offset = self._mount_offset(b)
        x, y, z = (
            (math.sin(b) * math.cos(a + offset), math.sin(b) * math.sin(a + offset), math.cos(b))
            for a in self._azimuth
        )
        self._mounts = (x, y, z)
        fall = math.pi - b
        far = a1 + a2 if a1 + a2 <= math.pi else math.tau - a1 - a2
        self.reach = min(fall - abs(a1 - a2), far - fall)
        """Tilt (rad) that the head can reach in every direction, without regard to arm gaps."""
        self._home = _linearise(self._mounts, self._elbows((0.0, 0.0, 0.0)), self._c2)
        if self.reach <= 0 or abs(self._home.det) < 1e-6:
            raise bad_value(f"A neck of {geometry} cannot move from upright. Check its angles.")
        self._frame = inverse_of_columns(x, y, cross(x, y))

    def _mount_offset(self, mount_angle: float) -> float:
        """Return the azimuth (rad) from arm to mount at home, from the closure there; raises Refused (BAD_VALUE)."""
        divisor = self._s1 * math.sin(mount_angle)
        cosine = (self._c2 + self._c1 * math.cos(mount_angle)) / divisor if divisor else math.inf
        if abs(cosine) >= 1:
            raise bad_value(
                f"A neck of {self.geometry} does not close upright; rod_twist must lie strictly between "
                "|180° - mount_angle - arm_angle| and 180° - mount_angle + arm_angle.",
            )
        return self._hand * math.acos(cosine)

    def inverse(self, yaw: float, pitch: float, roll: float) -> Arms:
        """Return the exact arm angles (rad) for a head orientation (rad); yaw may be any number of turns.

        Rods and mounts give a closed form with one arc cosine per arm; `hand` decides its sign. At yaw 0 every arm is
        within half a turn of home, so each angle is wrapped to that range before the yaw is added. Raises Refused:
        BAD_VALUE, OUT_OF_REACH.
        """
        if not math.isfinite(yaw + pitch + roll):
            raise bad_value(
                f"Yaw {yaw}, pitch {pitch}, roll {roll}: all three must be finite angles in rad.",
            )
        if abs(pitch) >= math.pi / 2 or abs(roll) >= math.pi / 2:
            raise self._out_of_reach(pitch, roll)
        sp, cp, sr, cr = math.sin(pitch), math.cos(pitch), math.sin(roll), math.cos(roll)
        angles = []
        for azimuth, (mx, my, mz) in zip(self._azimuth, self._mounts, strict=True):
            side = sr * my + cr * mz
            vx = cp * mx + sp * side
            vy = cr * my - sr * mz
            vz = cp * side - sp * mx
            level = self._s1 * math.hypot(vx, vy)
            k = self._c2 + self._c1 * vz
            if abs(k) > level:
                raise self._out_of_reach(pitch, roll)
            angle = math.atan2(vy, vx) - self._hand * math.acos(k / level) - azimuth
            angles.append(yaw + math.remainder(angle, math.tau))
        x, y, z = angles
        return x, y, z

    def _out_of_reach(self, pitch: float, roll: float) -> Refused:
        detail = Detail(
            limit=Limit.TILT, value=tilt_of(pitch, roll), high=self.reach, unit="rad", at_goal=True
        )
        return Refused(Reason.OUT_OF_REACH, detail=detail)

    def forward(self, arms: Sequence[float]) -> tuple[float, float, float]:
        """Return yaw, pitch, roll (rad) for arm angles (rad) in the home assembly; yaw may be any number of turns.

        Raises BeatrixError: OUT_OF_REACH if no head orientation of the home assembly fits the arms; BAD_VALUE if an
        angle is not finite.
        """
        solution = self._solve(arms)
        yaw, pitch, roll = ypr_of(self._attitude(solution.mounts))
        return solution.mean + yaw, pitch, roll

    def rotation(self, arms: Sequence[float]) -> Rotation:
        """Return the head orientation as rows of a 3x3 matrix; raises the errors of `forward`."""
        solution = self._solve(arms)
        c, s = math.cos(solution.mean), math.sin(solution.mean)
        x, y, z = self._attitude(solution.mounts)
        return (
            (c * x[0] - s * y[0], c * x[1] - s * y[1], c * x[2] - s * y[2]),
            (s * x[0] + c * y[0], s * x[1] + c * y[1], s * x[2] + c * y[2]),
            z,
        )

    def head(self, arms: Sequence[float]) -> HeadDerivatives:
        """Return yaw and tilt with their derivatives by the arms; raises the errors of `forward`.

        Closure in rates: n_i . omega = n_iz * dt_i with n_i = v_i x w_i.
        """
        solution = self._solve(arms)
        rows = self._attitude(solution.mounts)
        (ax, _, hx), (ay, _, hy), (az, _, up) = rows
        slope = az / (ax * ax + ay * ay)
        yaw_by, up_by = [], []
        for nz, (x, y, z) in zip(solution.linear.normal_z, solution.linear.inverse, strict=True):
            yaw_by.append(nz * (z - slope * (x * ax + y * ay)))
            up_by.append(nz * (x * hy - y * hx))
        return HeadDerivatives(
            solution.mean + math.atan2(ay, ax),
            up,
            (yaw_by[0], yaw_by[1], yaw_by[2]),
            (up_by[0], up_by[1], up_by[2]),
        )

    def gaps(self, arms: Sequence[float]) -> Arms:
        """Return the gaps between the arms (rad): short-middle, middle-long, long-short; 120 deg each at home."""
        x, y, z = arms
        first = self._spacing + self._order * (y - x)
        second = self._spacing + self._order * (z - y)
        return first, second, math.tau - first - second

    def in_home_assembly(self, arms: Sequence[float], rotation: Rotation) -> bool:
        """Return whether head and arms are assembled as at home; False: the mechanism has snapped through.

        arms: rad. rotation: rows of the head's 3x3 orientation, measured or calculated. Exactly one of the
        four or eight orientations that close on the same arms passes.
        """
        mounts = [(dot(rotation[0], m), dot(rotation[1], m), dot(rotation[2], m)) for m in self._mounts]
        normals = [cross(v, w) for v, w in zip(mounts, self._elbows(arms), strict=True)]
        det = dot(normals[0], cross(normals[1], normals[2]))
        return det * self._home.det > 0 and all(self._hand * n[2] < 0 for n in normals)

    def _elbows(self, arms: Sequence[float]) -> Triple:
        s1, c1 = self._s1, self._c1
        x, y, z = self._azimuth
        x, y, z = x + arms[0], y + arms[1], z + arms[2]
        return (
            (s1 * math.cos(x), s1 * math.sin(x), -c1),
            (s1 * math.cos(y), s1 * math.sin(y), -c1),
            (s1 * math.cos(z), s1 * math.sin(z), -c1),
        )

    def _solve(self, arms: Sequence[float]) -> _Solution:
        """Solve the closures by Newton's method on SO(3), from the linear solution at home."""
        x, y, z = arms
        mean = (x + y + z) / 3
        x, y, z = x - mean, y - mean, z - mean
        if not math.isfinite(x + y + z):
            raise BeatrixError(Reason.BAD_VALUE, f"Arms {arms}: all three must be finite angles in rad.")
        elbows = self._elbows((x, y, z))
        nx, ny, nz = self._home.normal_z
        mounts = _moved(self._mounts, self._home.inverse, (x * nx, y * ny, z * nz))[0]
        for _ in range(_MAX_ITERATIONS):
            linear = _linearise(mounts, elbows, self._c2)
            if linear.det * self._home.det <= 0:
                break
            x, y, z = linear.error
            mounts, square = _moved(mounts, linear.inverse, (-x, -y, -z))
            if square < _CONVERGED:
                if max(linear.normal_z) < 0 if self._hand > 0 else min(linear.normal_z) > 0:
                    return _Solution(mean, mounts, linear)
                break
        degrees = ", ".join(f"{math.degrees(angle):.1f}" for angle in arms)
        raise BeatrixError(
            Reason.OUT_OF_REACH,
            f"No orientation of the head is possible with the arms at {degrees}°: the counted positions are wrong, or "
            "the neck has snapped through. Switch the motors off, set the head upright, switch them on and calibrate.",
        )

    def _attitude(self, mounts: Triple) -> Rotation:
        """Return the rows of the orientation that turns the mount axes at home to `mounts`."""
        (ux, uy, uz), (vx, vy, vz) = mounts[0], mounts[1]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        (a, b, c), (d, e, f), (g, h, i) = self._frame
        return (
            (ux * a + vx * d + nx * g, ux * b + vx * e + nx * h, ux * c + vx * f + nx * i),
            (uy * a + vy * d + ny * g, uy * b + vy * e + ny * h, uy * c + vy * f + ny * i),
            (uz * a + vz * d + nz * g, uz * b + vz * e + nz * h, uz * c + vz * f + nz * i),
        )


def _linearise(mounts: Triple, elbows: Triple, cos_twist: float) -> _Linear:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = mounts
    (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = elbows
    lx, ly, lz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
    mx, my, mz = by * vz - bz * vy, bz * vx - bx * vz, bx * vy - by * vx
    nx, ny, nz = cy * wz - cz * wy, cz * wx - cx * wz, cx * wy - cy * wx
    px, py, pz = my * nz - mz * ny, mz * nx - mx * nz, mx * ny - my * nx
    det = lx * px + ly * py + lz * pz
    k = 1 / det if det else 0.0
    return _Linear(
        (
            ax * ux + ay * uy + az * uz - cos_twist,
            bx * vx + by * vy + bz * vz - cos_twist,
            cx * wx + cy * wy + cz * wz - cos_twist,
        ),
        (lz, mz, nz),
        det,
        (
            (px * k, py * k, pz * k),
            ((ny * lz - nz * ly) * k, (nz * lx - nx * lz) * k, (nx * ly - ny * lx) * k),
            ((ly * mz - lz * my) * k, (lz * mx - lx * mz) * k, (lx * my - ly * mx) * k),
        ),
    )


def _moved(mounts: Triple, inverse: Triple, right: Arms) -> tuple[Triple, float]:
    """Return the mounts after a step that solves the linearised closure, and the square of the full step (rad2)."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = inverse
    a, b, c = right
    x, y, z = a * ax + b * bx + c * cx, a * ay + b * by + c * cy, a * az + b * bz + c * cz
    square = x * x + y * y + z * z
    if square > _MAX_TURN * _MAX_TURN:
        k = _MAX_TURN / math.sqrt(square)
        x, y, z = k * x, k * y, k * z
    return turned(mounts, (x, y, z)), square
