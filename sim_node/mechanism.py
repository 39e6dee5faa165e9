"""The mechanism inside the simulated robot, hidden at first: the solids of `recording.mechanism` in a MuJoCo model."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import mujoco

from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.recording.figure import Figure
from beatrix_zenoh.recording.mechanism import mechanism
from sim_node.model import build_spec
from sim_node.picture import picture, png
from sim_node.visuals import COLLISION, MATERIALS, VISUAL, add_solid, opaque

MECHANISM: Final = 4
"""Geom group of the mechanism; MuJoCo's viewer shows and hides a group with the key of its number."""
SKIN_OPACITY: Final = 0.22
"""Opacity of the robot around the mechanism."""
KEYS: Final = (
    f"In the window, key {MECHANISM} shows the mechanism inside the robot, key {COLLISION} the simple shapes with mass "
    "that can touch each other."
)


def add_mechanism(spec: mujoco.MjSpec, robot: RobotData = ROBOT, group: int = MECHANISM) -> None:
    """Add the mechanism to a model of this robot, in a group that is hidden unless another one is given."""
    for body in mechanism(Figure(robot.geometry, robot.head)):
        for solid in body.solids:
            add_solid(spec, body.path, solid, group, rgba=opaque(solid.colour))


def write_mechanism(path: Path) -> None:
    """Write a picture of the mechanism inside the translucent robot, as a PNG file; raises OSError."""
    spec = build_spec()
    add_mechanism(spec, group=VISUAL)
    for name in MATERIALS.values():
        spec.material(name).rgba[3] = SKIN_OPACITY
    path.write_bytes(png(picture((0.0, 0.0, 0.0), 800, 720, spec)))


def show_through(model: mujoco.MjModel, *, through: bool) -> None:
    """Make the robot translucent, so that its mechanism is seen, or opaque again."""
    for name in MATERIALS.values():
        model.material(name).rgba[3] = SKIN_OPACITY if through else 1.0
