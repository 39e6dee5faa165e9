"""Vectors and rotations as plain floats, with roll-pitch-yaw angles as in REP-103."""

from __future__ import annotations

import math

Vector = tuple[float, float, float]
Triple = tuple[Vector, Vector, Vector]
Rotation = Triple
"""Rows of a 3x3 rotation matrix."""


def dot(u: Vector, v: Vector) -> float:
    """Return the scalar product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def cross(u: Vector, v: Vector) -> Vector:
    """Return the vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def inverse_of_columns(x: Vector, y: Vector, z: Vector) -> Triple:
    """Return the rows of the inverse of the matrix with these columns."""
    det = dot(x, cross(y, z))
    rows = cross(y, z), cross(z, x), cross(x, y)
    return tuple((r[0] / det, r[1] / det, r[2] / det) for r in rows)  # type: ignore[return-value] # three rows


def turned(vectors: Triple, turn: Vector) -> Triple:
    """Return the vectors turned about `turn` by 2 atan(|turn| / 2) rad: |turn| except for terms of third order.

    This is Cayley's map: an exact rotation, and faster to compute than the exponential map.
    """
    x, y, z = turn[0] / 2, turn[1] / 2, turn[2] / 2
    k = 2 / (1 + x * x + y * y + z * z)
    kx, ky, kz = k * x, k * y, k * z
    a, e, i = 1 - ky * y - kz * z, 1 - kx * x - kz * z, 1 - kx * x - ky * y
    b, c, f = kx * y - kz, kx * z + ky, ky * z - kx
    d, g, h = kx * y + kz, kx * z - ky, ky * z + kx
    (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = vectors
    return (
        (a * ux + b * uy + c * uz, d * ux + e * uy + f * uz, g * ux + h * uy + i * uz),
        (a * vx + b * vy + c * vz, d * vx + e * vy + f * vz, g * vx + h * vy + i * vz),
        (a * wx + b * wy + c * wz, d * wx + e * wy + f * wz, g * wx + h * wy + i * wz),
    )


def rotation_of(yaw: float, pitch: float, roll: float) -> Rotation:
    """Return Rz(yaw) Ry(pitch) Rx(roll), angles in rad: yaw left, pitch nose down, roll right ear down positive."""
    sy, cy, sp, cp = math.sin(yaw), math.cos(yaw), math.sin(pitch), math.cos(pitch)
    sr, cr = math.sin(roll), math.cos(roll)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def ypr_of(rotation: Rotation) -> Vector:
    """Return yaw, pitch and roll (rad) of a rotation; yaw and roll within half a turn, pitch within a quarter."""
    (ax, _, _), (ay, _, _), (az, bz, cz) = rotation
    return math.atan2(ay, ax), math.atan2(-az, math.hypot(ax, ay)), math.atan2(bz, cz)


def tilt_of(pitch: float, roll: float) -> float:
    """Return the angle (rad) between the head's axis and the vertical; yaw does not matter."""
    # Use atan2 with the horizontal part, because acos loses half of the digits near upright.
    sp, cp, sr, cr = math.sin(pitch), math.cos(pitch), math.sin(roll), math.cos(roll)
    return math.atan2(math.hypot(sp * cr, sr), cp * cr)


def leaning(tilt: float, direction: float) -> tuple[float, float]:
    """Return pitch and roll (rad) of a head tilted by `tilt` towards `direction` (rad)."""
    level = math.sin(tilt)
    return math.asin(level * math.cos(direction)), math.atan2(level * math.sin(direction), math.cos(tilt))
