"""The mechanism inside the simulated robot, hidden at first: the solids of `recording.mechanism` in a MuJoCo model."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import mujoco
import numpy as np

from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.recording.figure import Figure, Form, Solid
from beatrix_zenoh.recording.mechanism import mechanism
from sim_node.model import build_spec
from sim_node.picture import picture, png
from sim_node.visuals import COLLISION, MATERIALS, VISUAL

MECHANISM: Final = 4
"""Geom group of the mechanism; MuJoCo's viewer shows and hides a group with the key of its number."""
SKIN_OPACITY: Final = 0.22
"""Opacity of the robot around the mechanism."""
KEYS: Final = (
    f"In the window, key {MECHANISM} shows the mechanism inside the robot, key {COLLISION} the simple shapes with mass "
    "that can touch each other."
)
_SHAPES: Final = {
    Form.ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    Form.CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
    Form.CAPSULE: mujoco.mjtGeom.mjGEOM_CAPSULE,
}


def add_mechanism(spec: mujoco.MjSpec, robot: RobotData = ROBOT, group: int = MECHANISM) -> None:
    """Add the mechanism to a model of this robot, in a group that is hidden unless another one is given."""
    for body in mechanism(Figure(robot.geometry, robot.head)):
        name = body.path.rpartition("/")[2]
        target = spec.worldbody if name == "base" else spec.body(name)
        for solid in body.solids:
            _add_solid(target, solid, group)


def _add_solid(body: mujoco.MjsBody, solid: Solid, group: int) -> None:
    x, y, z, w = solid.quaternion
    quat, pos, size = np.array((w, x, y, z)), np.array(solid.position), list(solid.size)
    if solid.form is not Form.ELLIPSOID:
        size[1] /= 2  # MuJoCo wants half of the length
    if solid.form is Form.CAPSULE:
        axis = np.zeros(3)
        mujoco.mju_rotVecQuat(axis, np.array((0.0, 0.0, 1.0)), quat)
        pos = pos + axis * size[1]
    geom = body.add_geom(
        type=_SHAPES[solid.form],
        size=[*size, 0.0][:3],
        pos=pos,
        quat=quat,
        rgba=[*(part / 255 for part in solid.colour), 1.0],
        mass=0.0,
        group=group,
    )
    geom.contype = geom.conaffinity = 0


def write_mechanism(path: Path) -> None:
    """Write a picture of the mechanism inside the translucent robot, as a PNG file; raises OSError."""
    spec = build_spec()
    add_mechanism(spec, group=VISUAL)
    for name in MATERIALS:
        spec.material(name).rgba[3] = SKIN_OPACITY
    path.write_bytes(png(picture((0.0, 0.0, 0.0), 800, 720, spec)))


def show_through(model: mujoco.MjModel, *, through: bool) -> None:
    """Make the robot translucent, so that its mechanism is seen, or opaque again."""
    for name in MATERIALS:
        model.material(name).rgba[3] = SKIN_OPACITY if through else 1.0
