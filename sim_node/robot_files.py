"""`beatrix model`: write the robot as a file for other programs, MJCF for MuJoCo or URDF for ROS, Rerun and others.

- MJCF (`.xml`): the model of the simulation, whole: loops, motors, masses, shapes, cameras.
- URDF (`.urdf`): the same bodies as a tree, because URDF has no closed loops; a comment in the file names the points
  where they close. The head turns by the joints yaw, pitch and roll; the angles of arms and rods that belong to them are
  those of `beatrix_zenoh.motion.kinematics` and of `Chain.rod_angle`.
- `NAME-meshes/BODY_COLOUR.stl`, beside the URDF: the surfaces of one colour of a body, in m, in the frame of the body,
  whose origin is the neck centre. Binary STL, little-endian: 80 bytes of text, the number of triangles (uint32), then for
  each triangle 12 float32, the normal and three corners (counter-clockwise seen from outside), and two bytes 0.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Final
from xml.etree import ElementTree as ET

import mujoco
import numpy as np
import typer

from beatrix_zenoh.body.figure import Figure, meshes, scaled
from beatrix_zenoh.body.surface import Floats, Mesh
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.files import check_new, new_file
from beatrix_zenoh.motion.robot_file import load
from beatrix_zenoh.output import say
from beatrix_zenoh.terminal.options import RobotFile
from beatrix_zenoh.terminal.run import run_command
from sim_node.model import build_spec, ratio, rod_range
from sim_node.visuals import MATERIALS, opaque

MJCF, URDF = ".xml", ".urdf"
TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("zero", "<u2")])
TINY_KG: Final = 1e-4
"""Mass of the links between the joints of the head: simulators refuse links without mass."""
HEAD_JOINTS: Final = {"yaw": (0.0, 0.0, 1.0), "pitch": (0.0, 1.0, 0.0), "roll": (1.0, 0.0, 0.0)}


def model(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Ends in .xml (MJCF) or .urdf; meshes of a URDF are beside it."),
    ],
    robot_file: RobotFile = None,
) -> None:
    """Write the robot for other programs: MJCF for MuJoCo, or URDF with meshes for ROS, Rerun and others.

    MJCF is the model of the simulation in one file, with closed loops and motors. URDF has no closed loops: the head turns
    by three joints. docs/how-to/model.md describes both.
    """
    if file.suffix not in (MJCF, URDF):
        raise typer.BadParameter(f"{file}: the name must end in {MJCF} (MJCF, for MuJoCo) or {URDF}.")
    write(file, load(robot_file))
    say(f"{file}: {'MJCF, all in one file' if file.suffix == MJCF else f'URDF, with {meshes_of(file)}'}.")


def write(file: Path, robot: RobotData = ROBOT) -> None:
    """Write the robot into a new file of this ending; raises Refused if it exists or cannot be written."""
    check_new(file)
    with new_file(file) as unfinished:
        if file.suffix == MJCF:
            spec = build_spec(robot)
            spec.visual.headlight.ambient, spec.visual.headlight.diffuse = (
                [0.45] * 3,
                [0.55] * 3,
            )  # its only light
            unfinished.write_text(spec.to_xml(), encoding="utf-8")
            return
        folder = meshes_of(file)
        check_new(folder)
        folder.mkdir()
        ET.ElementTree(urdf(robot, folder)).write(unfinished, encoding="utf-8", xml_declaration=True)


def meshes_of(file: Path) -> Path:
    """Return the folder of the meshes of a URDF file."""
    return file.with_name(f"{file.stem}-meshes")


def urdf(robot: RobotData, folder: Path) -> ET.Element:
    """Return the robot as URDF, and write its meshes into a folder; raises OSError."""
    model = build_spec(robot).compile()
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
        point = " ".join(f"{number:.6f}" for number in scaled(chain.mount, robot.head.mount_radius))
        root.append(ET.Comment(f" closed loop: the point {point} of rod_{name} stays at that of head "))
        add_joint(root, f"arm_{name}", ("base", f"arm_{name}"), (0.0, 0.0, 1.0), None, (effort, speed))
        limits = rod_range(chain)
        add_joint(root, f"rod_{name}", (f"arm_{name}", f"rod_{name}"), chain.elbow, limits, (0.0, speed))
    parents = ("base", "yaw", "pitch", "head")
    for index, (name, axis) in enumerate(HEAD_JOINTS.items()):
        furthest = np.radians(robot.limits.yaw_max if name == "yaw" else robot.limits.tilt_max)
        add_joint(root, name, parents[index : index + 2], axis, (-furthest, furthest), (0.0, speed))
    ET.indent(root)
    return root


def add_visuals(link: ET.Element, mesh: Mesh, folder: Path) -> None:
    """Write the meshes of a body, and name them in its link."""
    by_colour: dict[tuple[int, int, int], list[Floats]] = {}
    for colour, triangles in mesh.solids():
        by_colour.setdefault(colour, []).append(mesh.points[triangles])
    for colour, corners in by_colour.items():
        name = f"{mesh.body}_{MATERIALS[colour]}.stl"
        (folder / name).write_bytes(stl(np.concatenate(corners)))
        visual = ET.SubElement(link, "visual")
        ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=f"{folder.name}/{name}")
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


def main(words: list[str] | None = None) -> int:
    """Run `beatrix model`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(model, "beatrix model", words)
