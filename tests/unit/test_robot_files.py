"""The robot as MJCF and URDF: programs load both, and they are the robot of the simulation."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import pytest
from rerun.urdf import UrdfTree

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.surface import Floats, triangles
from beatrix_zenoh.cli import app
from beatrix_zenoh.contract._generated.robot import GeometryData, RobotData
from beatrix_zenoh.contract.names import ARMS
from sim_node import robot_files
from sim_node.model import mechanics

ROBOT = RobotData(geometry=GeometryData(hand=-1, rod_twist=80.0))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot")
    for ending in (".xml", ".urdf"):
        robot_files.write(folder / f"beatrix{ending}", ROBOT)
    return folder


def test_mujoco_loads_the_mjcf_and_it_moves_as_the_simulation(folder: Path) -> None:
    """The twin computes with `mechanics`, which has none of the visible shapes."""
    loaded = mujoco.MjModel.from_xml_path(str(folder / "beatrix.xml"))
    curves: list[list[Floats]] = []
    for model in (loaded, mechanics(ROBOT).compile()):
        data = mujoco.MjData(model)
        curves.append([])
        for step in range(500):
            data.ctrl[:] = np.radians(10.0) * np.sin(step / 100 + np.arange(3))
            mujoco.mj_step(model, data)
            curves[-1].append(data.qpos.copy())
    assert np.ptp(curves[0], axis=0).max() > 0.3
    np.testing.assert_allclose(curves[0], curves[1], atol=1e-4)


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


def test_the_urdf_names_where_its_loops_close(folder: Path) -> None:
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    nodes = ET.parse(folder / "beatrix.urdf", parser).iter()
    texts = [str(node.text) for node in nodes if "closed loop" in str(node.text)]
    data = mujoco.MjData(model := mechanics(ROBOT).compile())
    mujoco.mj_forward(model, data)
    assert len(texts) == len(ARMS)
    for name, text in zip(ARMS, texts, strict=True):
        assert f"rod_{name}" in text
        point = [float(word) for word in text.partition("point ")[2].split()[:3]]
        np.testing.assert_allclose(point, data.site(f"rod_{name}").xpos, atol=1e-6)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ("head.xml", 0, "head.xml: MJCF, all in one file."),
        ("head.urdf", 0, "head.urdf: URDF, with head-meshes."),
        ("head.sdf", 2, "must end in .xml (MJCF, for MuJoCo) or .urdf"),
        ("kept.xml", 1, "kept.xml exists and is not overwritten"),
        ("mine.urdf", 1, "mine-meshes exists and is not overwritten"),
        ("missing/head.urdf", 1, "missing/head.urdf cannot be written: No such file"),
        ("head.xml --robot-file none.toml", 2, "--robot-file none.toml cannot be read"),
    ],
)
def test_the_verb_writes_one_file_or_names_the_cure(
    words: str, code: int, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    Path("kept.xml").write_text("mine")
    Path("mine-meshes").mkdir()
    assert app.run(["model", *words.split()]) == code
    assert says in " ".join("".join(capsys.readouterr()).split())
    assert Path(words).exists() == (code == 0 or words == "kept.xml")
    assert Path("kept.xml").read_text() == "mine"
