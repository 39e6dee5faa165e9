"""The robot as MJCF and URDF: programs load both, and they are the robot of the simulation."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
import robot_files
from rerun.urdf import UrdfTree

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.surface import triangles
from beatrix_zenoh.contract._generated.robot import GeometryData, RobotData
from beatrix_zenoh.contract.names import ARMS
from sim_node.model import build_spec

ROBOT = RobotData(geometry=GeometryData(hand=-1, rod_twist=80.0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot")
    robot_files.write(folder, ROBOT)
    return folder


def test_mujoco_loads_the_model_of_the_simulation(folder: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(folder / "beatrix.xml"))
    known = build_spec(ROBOT).compile()
    assert (model.nq, model.nu, model.neq, model.ngeom) == (known.nq, known.nu, known.neq, known.ngeom)
    np.testing.assert_allclose(model.body_mass, known.body_mass, rtol=1e-5)
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.2
    mujoco.mj_step(model, data, 500)
    assert data.joint("arm_short").qpos[0] == pytest.approx(0.2, abs=0.01)


def test_rerun_loads_the_urdf_with_its_meshes(folder: Path) -> None:
    tree = UrdfTree.from_file_path(folder / "beatrix.urdf")
    chains = [f"{part}_{name}" for name in ARMS for part in ("arm", "rod")]
    assert [joint.name for joint in tree.joints()] == [*chains, "yaw", "pitch", "roll"]
    for mesh in meshes(Figure(ROBOT.geometry), fine=True):
        assert len(tree.get_visual_geometry_paths(mesh.body)) == len({colour for colour, _ in mesh.solids()})


def test_each_surface_is_in_a_mesh_of_its_colour(folder: Path) -> None:
    root = ET.parse(folder / "beatrix.urdf").getroot()
    for mesh in meshes(Figure(ROBOT.geometry), fine=True):
        files = [part.get("filename", "") for part in root.iterfind(f"link[@name='{mesh.body}']//mesh")]
        found = np.concatenate(
            [np.frombuffer((folder / file).read_bytes()[84:], robot_files.TRIANGLE) for file in files]
        )
        assert len(found) == len(triangles(mesh.faces))
        near = np.sort(mesh.points[triangles(mesh.faces)].reshape(-1, 3), axis=0)
        np.testing.assert_allclose(np.sort(found["corners"].reshape(-1, 3), axis=0), near, atol=1e-7)
