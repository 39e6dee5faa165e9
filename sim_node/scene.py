"""The scene for pictures: robot, room and person. The model of the physics contains the robot only.

Places are in m in the frame of the neck: x forward, y left, z up, origin in the neck centre.
"""

from __future__ import annotations

from typing import Final

import mujoco

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from sim_node.model import build_spec
from sim_node.person import add_person
from sim_node.room import add_room
from sim_node.visuals import add_camera

OUTSIDE: Final = ((0.655, 0.235, 0.13), (0.0, 0.0, 0.058), 32.0)
"""The outside camera: its place and the point that it looks at (m), and its vertical angle of view (deg)."""


def scene_spec(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model of robot, room and person; its joints, and so its qpos, are those of `build_spec`."""
    spec = build_spec(robot)
    add_room(spec)
    add_person(spec)
    add_camera(spec.worldbody, names.OUTSIDE, *OUTSIDE)
    return spec


def eye_scene(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the model of `scene_spec` for published pictures, simplified to save time."""
    spec = scene_spec(robot)
    quality = spec.visual.quality
    # All light is directional, so one quad for each wall is enough.
    quality.numquads = 1
    quality.numslices, quality.numstacks = 16, 10
    spec.delete(spec.texture("sky"))
    return spec
