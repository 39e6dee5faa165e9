"""Check a whole choreography before a robot moves."""

from __future__ import annotations

import math

from beatrix_zenoh.client.choreography import Choreography, Pose, Step
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.contract._generated.serial import Telemetry
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.node.planner import Planner
from beatrix_zenoh.recording.path import arms_of


def check_choreography(choreography: Choreography, robot: RobotData) -> None:
    """Check each pose and the path to it from the previous pose, as the robot would check them.

    The position before the first pose is unknown, so only the first pose itself and its speed are checked.

    Raises:
        Refused: a pose, a path or a speed exceeds a limit; the message names line and time.
    """
    planner = Planner(robot)
    here: Arms | None = None
    for index, (_title, step) in enumerate(choreography.steps):
        try:
            start = first_arms(step, planner) if here is None else here
            here = planner.goal(step.query(), resting(planner.gear.to_steps(start))).target
        except BeatrixError as error:
            where = choreography.where(index)
            raise type(error)(error.reason, f"{where}: {error.message}", error.detail) from error


def first_arms(step: Step, planner: Planner) -> Arms:
    """Return the arm angles (rad) of the first pose; raises Refused if it exceeds a limit or is out of reach."""
    if isinstance(step, Pose):
        place = arms_of(HeadAngles(step.yaw, step.pitch, step.roll), planner.limits)
    else:
        place = arms_of(ArmAngles(step.short, step.middle, step.long), planner.limits)
    x, y, z = (math.radians(angle) for angle in place)
    planner.limits.check_pose((x, y, z))
    return x, y, z


def resting(position: tuple[int, int, int]) -> Telemetry:
    """Return the telemetry of a board whose arms rest at this position (microsteps)."""
    return Telemetry(0, 0, 0, 0, 0, position, (0, 0, 0), 0, 0)
