"""The model of MuJoCo and the figure of 3D views: closed loops in any pose, and the mechanism."""

from __future__ import annotations

import itertools

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from beatrix_zenoh.body.figure import Figure, Quaternion, chains
from beatrix_zenoh.colours import ARMS
from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData, RobotData
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import Vector, rotation_of
from sim_node.model import build_spec, scene_spec
from sim_node.viewer import MECHANISM, add_mechanism
from sim_node.visuals import COLLISION, VISUAL

GEOMETRIES = [
    ROBOT.geometry,
    GeometryData(hand=-1),
    GeometryData(arm_angle=54.0),
    GeometryData(rod_twist=80.0, mount_angle=85.0, arm0_azimuth=0.0),
]


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_spec().compile()


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_home_is_qpos0_with_a_closed_loop(geometry: GeometryData) -> None:
    model = build_spec(RobotData(geometry=geometry)).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.qpos0.tolist() == [1.0] + [0.0] * 9
    assert np.abs(data.efc_pos[: 3 * model.neq]).max() < 1e-12


def test_hidden_geoms_have_the_mass_of_the_robot(model: mujoco.MjModel) -> None:
    head = ROBOT.head
    assert model.body("head").mass[0] == pytest.approx(head.mass)
    assert model.body_mass.sum() == pytest.approx(head.mass + 3 * head.arm_mass + 3 * head.rod_mass)
    assert set(model.geom_group.tolist()) == {VISUAL, COLLISION}
    assert not mujoco.MjvOption().geomgroup[COLLISION]


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_rod_angle_closes_the_loop_of_any_pose(geometry: GeometryData) -> None:
    model = build_spec(RobotData(geometry=geometry)).compile()
    data = mujoco.MjData(model)
    neck = Neck(geometry)
    for yaw, pitch, roll in itertools.product((-2.0, 0.3), (-0.3, 0.2), (-0.2, 0.4)):
        rotation = rotation_of(yaw, pitch, roll)
        arms = neck.inverse(yaw, pitch, roll)
        for name, chain, arm in zip(ARMS, chains(geometry), arms, strict=True):
            data.joint(f"arm_{name}").qpos = arm
            data.joint(f"rod_{name}").qpos = chain.rod_angle(arm, rotation)
        mujoco.mju_mat2Quat(data.joint("head").qpos, np.ravel(rotation))
        mujoco.mj_forward(model, data)
        assert np.abs(data.efc_pos[: 3 * model.neq]).max() < 1e-12


# -- the mechanism inside the robot: MuJoCo hides it at first --------------------------------------


def test_the_mechanism_is_hidden_at_first_and_changes_neither_masses_nor_contacts() -> None:
    plain, spec = build_spec().compile(), build_spec()
    add_mechanism(spec)
    model = spec.compile()
    added = model.geom_group == MECHANISM
    assert added.sum() > 30
    assert mujoco.MjvOption().geomgroup[MECHANISM] == 0
    assert not model.geom_contype[added].any()
    assert model.body_mass.tolist() == plain.body_mass.tolist()
    assert not (plain.geom_group == MECHANISM).any()
    assert not (scene_spec().compile().geom_group == MECHANISM).any(), "the eyes never draw it"


# -- the figure of 3D views, whose rotations are quaternions ----------------------------------------


LEFT_HANDED = GeometryData(hand=-1, rod_twist=80.0, mount_angle=100.0)


def turned(turn: Quaternion, vector: Vector) -> NDArray[np.float64]:
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
