"""The robot's shape in 3D views: closed loops, and the same rotations as in the MuJoCo model."""

from __future__ import annotations

import numpy as np
import pytest

from beatrix_zenoh.body.figure import Figure, Quaternion
from beatrix_zenoh.colours import ARMS
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Vector, rotation_of
from beatrix_zenoh.recording.samples import Floats

LEFT_HANDED = GeometryData(hand=-1, rod_twist=80.0, mount_angle=100.0)


def turned(turn: Quaternion, vector: Vector) -> Floats:
    """Return a vector turned by a quaternion."""
    x, y, z, w = turn
    axis, v = np.array((x, y, z)), np.array(vector)
    return np.asarray(v + 2 * np.cross(axis, np.cross(axis, v) + w * v), dtype=np.float64)


@pytest.mark.parametrize("geometry", [ROBOT.geometry, LEFT_HANDED])
@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (2.5, 0.3, -0.2), (-0.4, -0.35, 0.25), (9.0, 0.1, 0.4)])
def test_rods_end_where_the_head_is_mounted(geometry: GeometryData, pose: tuple[float, float, float]) -> None:
    figure, head = Figure(geometry), rotation_of(*pose)
    turns = figure.rotations(Neck(geometry).inverse(*pose), head)
    for name, (_, elbow, mount) in zip(ARMS, figure.chains, strict=True):
        arm, rod = turns[f"arm_{name}"], turns[f"arm_{name}/rod_{name}"]
        end = turned(arm, tuple(turned(rod, mount)))
        np.testing.assert_allclose(end, turned(turns["head"], mount), atol=1e-9)
        np.testing.assert_allclose(turned(rod, elbow), elbow, atol=1e-12)
