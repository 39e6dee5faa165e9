"""Write the robot as files for other programs: MJCF for MuJoCo, and URDF with meshes for ROS, Rerun and others.

.venv/bin/python tools/robot_files.py [--robot-file lab.toml] [--out FOLDER]

- `beatrix.xml` (MJCF): the model of the simulation, whole: loops, motors, masses, shapes, cameras.
- `beatrix.urdf`: the same bodies as a tree, because URDF has no closed loops. The head turns by the joints yaw, pitch
  and roll; the angles of arms and rods that belong to them are those of `beatrix_zenoh.motion.kinematics` and of
  `Chain.rod_angle`.
- `meshes/BODY_COLOUR.stl`: the surfaces of one colour of a body, in m, in the frame of the body, whose origin is the
  neck centre. Binary STL, little-endian: 80 bytes of text, the number of triangles (uint32), then for each triangle 12
  float32, the normal and three corners (counter-clockwise seen from outside), and two bytes 0.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.surface import Floats, Mesh
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.motion import robot_file
from sim_node.model import build_spec, ratio, rod_range
from sim_node.visuals import MATERIALS, opaque

OUT: Final = Path(__file__).resolve().parents[1] / "build" / "robot"
TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("zero", "<u2")])
TINY_KG: Final = 1e-4
"""Mass of the links between the joints of the head: simulators refuse links without mass."""
HEAD_JOINTS: Final = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0), "roll": (1.0, 0.0, 0.0)}


def write(folder: Path, robot: RobotData = ROBOT) -> None:
    """Write all files into a folder; raises OSError."""
    (folder / "meshes").mkdir(parents=True, exist_ok=True)
    spec = build_spec(robot)
    model = spec.compile()
    (folder / "beatrix.xml").write_text(spec.to_xml(), encoding="utf-8")
    shape = {mesh.body: mesh for mesh in meshes(Figure(robot.geometry, robot.head), fine=True)}
    root = ET.Element("robot", name="beatrix")
    for body in ("base", "yaw", "pitch", *(mesh for mesh in shape if mesh != "base")):
        link = ET.SubElement(root, "link", name=body)
        if body in shape:
            add_visuals(link, shape[body], folder)
        if body != "base":
            add_inertia(link, model, body)
    speed = robot.limits.speed_max
    effort = robot.drive.holding_torque * ratio(robot.drive) * robot.drive.efficiency
    for name, chain in zip(ARMS, Figure(robot.geometry).chains, strict=True):
        add_joint(root, f"arm_{name}", ("base", f"arm_{name}"), (0.0, 0.0, 1.0), None, (effort, speed))
        limits = rod_range(chain)
        add_joint(root, f"rod_{name}", (f"arm_{name}", f"rod_{name}"), chain.elbow, limits, (0.0, speed))
    parents = ("base", "yaw", "pitch", "head")
    for index, (name, axis) in enumerate(HEAD_JOINTS.items()):
        furthest = np.radians(robot.limits.yaw_max if name == "yaw" else robot.limits.tilt_max)
        add_joint(root, name, parents[index : index + 2], axis, (-furthest, furthest), (0.0, speed))
    ET.indent(root)
    ET.ElementTree(root).write(folder / "beatrix.urdf", encoding="utf-8", xml_declaration=True)


def add_visuals(link: ET.Element, mesh: Mesh, folder: Path) -> None:
    """Write the meshes of a body, and name them in its link."""
    by_colour: dict[tuple[int, int, int], list[Floats]] = {}
    for colour, triangles in mesh.solids():
        by_colour.setdefault(colour, []).append(mesh.points[triangles])
    for colour, corners in by_colour.items():
        name = f"{mesh.body}_{MATERIALS[colour]}.stl"
        (folder / "meshes" / name).write_bytes(stl(np.concatenate(corners)))
        visual = ET.SubElement(link, "visual")
        ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=f"meshes/{name}")
        material = ET.SubElement(visual, "material", name=MATERIALS[colour])
        ET.SubElement(material, "color", rgba=spaced(opaque(colour)))


def stl(corners: Floats) -> bytes:
    """Return a binary STL file of triangles, (k, 3, 3)."""
    found = np.zeros(len(corners), TRIANGLE)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    found["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    found["corners"] = corners
    return b"BEATRIX".ljust(80) + np.uint32(len(corners)).tobytes() + found.tobytes()


def add_inertia(link: ET.Element, model: mujoco.MjModel, body: str) -> None:
    """Add the mass of a body as the simulation has it; those between base and head have nearly none."""
    mass, centre, tensor = TINY_KG, np.zeros(3), np.eye(3) * TINY_KG * 1e-4
    if body not in HEAD_JOINTS:
        part, turn = model.body(body), np.zeros(9)
        mujoco.mju_quat2Mat(turn, part.iquat)
        axes = turn.reshape(3, 3)
        mass, centre, tensor = float(part.mass[0]), part.ipos, axes @ np.diag(part.inertia) @ axes.T
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=spaced(centre))
    ET.SubElement(inertial, "mass", value=spaced([mass]))
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    ET.SubElement(inertial, "inertia", {name: spaced([tensor[at]]) for name, at in places.items()})


def add_joint(
    root: ET.Element,
    name: str,
    links: tuple[str, ...],
    axis: Iterable[float],
    limits: tuple[float, float] | None,
    most: tuple[float, float],
) -> None:
    """Add a joint in the neck centre: angles in rad, `None` turns without end; `most`: torque (N m), speed (deg/s)."""
    parent, child = links
    joint = ET.SubElement(root, "joint", name=name, type="revolute" if limits else "continuous")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "axis", xyz=spaced(axis))
    ends = {"lower": spaced([limits[0]]), "upper": spaced([limits[1]])} if limits else {}
    effort, speed = most
    ET.SubElement(
        joint, "limit", ends | {"effort": spaced([effort]), "velocity": spaced([np.radians(speed)])}
    )


def spaced(numbers: Iterable[float]) -> str:
    """Return numbers for an attribute."""
    return " ".join(f"{number:.9g}" for number in numbers)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--robot-file", type=Path, help="values of your robot, as of `beatrix sim --robot-file`"
    )
    parser.add_argument("--out", type=Path, default=OUT, help="folder (default: build/robot)")
    arguments = parser.parse_args()
    try:
        robot = robot_file.load(arguments.robot_file) if arguments.robot_file else ROBOT
        write(arguments.out, robot)
    except (BeatrixError, OSError) as error:
        parser.error(str(error))
    print("wrote", arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
