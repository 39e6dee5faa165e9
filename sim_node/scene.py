"""The scene for pictures: robot, room and person. The model of the physics contains the robot only.

The room is the file `room/room.xml`; its origin is on the desk, below the neck. Other places are in m in the frame of
the neck: x forward, y left, z up, origin in the neck centre.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import mujoco

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, RobotData
from sim_node.model import build_spec
from sim_node.visuals import add_camera

ROOM: Final = Path(__file__).with_name("room") / "room.xml"
PREFIX: Final = "room/"
"""Before the names of bodies and geoms of the room; the body `room/person` is the person."""
OUTSIDE: Final = ((0.655, 0.235, 0.13), (0.0, 0.0, 0.058), 32.0)
"""The outside camera: its place and the point that it looks at (m), and its vertical angle of view (deg)."""


def scene_spec(robot: RobotData = ROBOT) -> mujoco.MjSpec:
    """Return the editable model of robot, room and person; its joints, and so its qpos, are those of `build_spec`."""
    spec = build_spec(robot)
    for part in (spec.geom("floor"), *spec.lights):
        spec.delete(part)
    room = mujoco.MjSpec.from_file(str(ROOM))
    spec.visual.headlight = room.visual.headlight
    spec.attach(room, prefix=PREFIX, frame=spec.worldbody.add_frame(pos=[0.0, 0.0, SIZES.floor]))
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
