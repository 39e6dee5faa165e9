from __future__ import annotations

import itertools
import math

import mujoco
import numpy as np
import pytest

from beatrix_zenoh.contract._generated.robot import ROBOT, GeometryData, RobotData
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.recording.figure import chains
from sim_node.model import build, build_spec, rod_range
from sim_node.visuals import COLLISION, VISUAL

GEOMETRIES = [
    ROBOT.geometry,
    GeometryData(hand=-1),
    GeometryData(arm_angle=54.0),
    GeometryData(rod_twist=80.0, mount_angle=85.0, arm0_azimuth=0.0),
]


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build()


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_home_is_qpos0_with_a_closed_loop(geometry: GeometryData) -> None:
    model = build(RobotData(geometry=geometry))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.qpos0.tolist() == [1.0] + [0.0] * 9
    assert np.abs(data.efc_pos[: 3 * model.neq]).max() < 1e-12


def test_visible_geoms_have_no_mass_and_no_contact(model: mujoco.MjModel) -> None:
    seen = model.geom_group == VISUAL
    assert seen.any()
    assert not model.geom_contype[seen].any()
    assert not model.geom_conaffinity[seen].any()


def test_hidden_geoms_have_the_mass_of_the_robot(model: mujoco.MjModel) -> None:
    head = ROBOT.head
    assert model.body("head").mass[0] == pytest.approx(head.mass)
    assert model.body_mass.sum() == pytest.approx(head.mass + 3 * head.arm_mass + 3 * head.rod_mass)
    assert set(model.geom_group.tolist()) == {VISUAL, COLLISION}
    assert not mujoco.MjvOption().geomgroup[COLLISION]


def test_the_centre_of_mass_of_the_head_is_that_of_the_robot_data(model: mujoco.MjModel) -> None:
    assert model.body("head").ipos == pytest.approx([0.0, 0.0, ROBOT.head.centre_height])


def test_the_eyes_look_ahead_from_both_ends_of_the_baseline(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    left, right = data.camera("eye_left"), data.camera("eye_right")
    assert left.xpos - right.xpos == pytest.approx([0.0, ROBOT.head.eye_baseline, 0.0])
    for eye in (left, right):
        assert -eye.xmat.reshape(3, 3)[:, 2] == pytest.approx([1.0, 0.0, 0.0])
        assert eye.xmat.reshape(3, 3)[:, 1] == pytest.approx([0.0, 0.0, 1.0])
    assert model.camera("eye_left").fovy[0] == ROBOT.head.eye_fov


def test_no_eye_sees_its_own_head(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    group = np.array([0, 0, 1, 0, 0, 0], dtype=np.uint8)
    hit = np.zeros(1, dtype=np.int32)
    for name in ("eye_left", "eye_right"):
        for y, z in itertools.product(np.linspace(-0.75, 0.75, 9), np.linspace(-0.57, 0.57, 9)):
            ray = np.array([1.0, y, z]) / math.hypot(1.0, y, z)
            mujoco.mj_ray(model, data, data.camera(name).xpos, ray, group, 1, -1, hit)
            assert hit[0] == -1 or model.geom_bodyid[hit[0]] == 0


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_rod_angle_closes_the_loop_of_any_pose(geometry: GeometryData) -> None:
    model = build(RobotData(geometry=geometry))
    data = mujoco.MjData(model)
    neck = Neck(geometry)
    for yaw, pitch, roll in itertools.product((-2.0, 0.3), (-0.3, 0.2), (-0.2, 0.4)):
        rotation = rotation_of(yaw, pitch, roll)
        arms = neck.inverse(yaw, pitch, roll)
        for name, chain, arm in zip(("short", "middle", "long"), chains(geometry), arms, strict=True):
            data.joint(f"arm_{name}").qpos = arm
            data.joint(f"rod_{name}").qpos = chain.rod_angle(arm, rotation)
        mujoco.mju_mat2Quat(data.joint("head").qpos, np.ravel(rotation))
        mujoco.mj_forward(model, data)
        assert np.abs(data.efc_pos[: 3 * model.neq]).max() < 1e-12


def test_joint_stops_keep_the_rods_inside_the_home_assembly() -> None:
    for chain in chains(ROBOT.geometry):
        assert np.degrees(rod_range(chain)) == pytest.approx([-80.0, 80.0])


def test_the_model_can_be_written_as_mjcf() -> None:
    spec = build_spec()
    spec.compile()
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert (again.nq, again.nu, again.neq) == (10, 3, 3)
