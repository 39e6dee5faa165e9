"""The robot's shape in 3D views: closed loops, and the same rotations as in the MuJoCo model."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from beatrix_zenoh.body.figure import Figure, Quaternion
from beatrix_zenoh.colours import ARMS
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Vector, rotation_of
from beatrix_zenoh.recording.samples import Floats
from sim_node.model import build_spec

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


def test_bodies_turn_as_in_the_model() -> None:
    model = build_spec().compile()
    data = mujoco.MjData(model)
    arms, head = (0.3, -0.1, 0.2), rotation_of(*Neck().forward((0.3, -0.1, 0.2)))
    turns = Figure().rotations(arms, head)
    for name, angle, rod in zip(ARMS, arms, ("rod_short", "rod_middle", "rod_long"), strict=True):
        x, y, z, w = turns[f"arm_{name}/{rod}"]
        axis = model.joint(rod).axis
        data.joint(f"arm_{name}").qpos[0] = angle
        data.joint(rod).qpos[0] = 2 * math.atan2(np.dot((x, y, z), axis), w)
    x, y, z, w = turns["head"]
    data.joint("head").qpos[:] = (w, x, y, z)
    mujoco.mj_forward(model, data)
    for name in ARMS:  # the loops are closed, so the model agrees with the figure
        np.testing.assert_allclose(data.site(f"rod_{name}").xpos, data.site(f"mount_{name}").xpos, atol=1e-6)
