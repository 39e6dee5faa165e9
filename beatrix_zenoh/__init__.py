"""BEATRIX, the humanoid head for teaching robotics, over Zenoh.

with Robot("bea1", twin="sim") as robot:
    robot.enable()
    robot.calibrate()
    robot.look(yaw=20, pitch=-10)
"""

from __future__ import annotations

from beatrix_zenoh.errors import BeatrixError as BeatrixError
from beatrix_zenoh.errors import Interrupted as Interrupted
from beatrix_zenoh.errors import NoAnswer as NoAnswer
from beatrix_zenoh.errors import Refused as Refused
from beatrix_zenoh.robot import Robot as Robot
from beatrix_zenoh.twin import Plan as Plan
from beatrix_zenoh.twin import Twin as Twin
