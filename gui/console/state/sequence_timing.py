"""When the poses of a sequence begin, how fast the arms turn, and which poses the limits do not allow."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Final

from msgspec.structs import replace

from beatrix_zenoh.client.choreography import ArmPose
from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles
from beatrix_zenoh.contract._generated.robot import ALLOWED, ROBOT, LimitsData
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.motion.trajectory import shortest_s, speed_for
from gui.console.state.saved import DURATION_MAX_S, SavedPose
from gui.console.state.world import World

SETTLE_S: Final = 0.1
"""Part of each duration (s) in which the arms already rest: answers of the robot take a part of it."""
SAME_DEG: Final = 0.05
"""Arms that turn by less than this stay; such a pose is a pause."""
SLOWEST: Final = ALLOWED["limits"]["speed_max"].low
"""Lowest speed (deg/s); a pose that could be reached more slowly is reached earlier, and the arms rest until its end."""
HOME: Final = ArmAngles(0.0, 0.0, 0.0)
NECK: Final = Neck()
REPORTED: Final = ("speed_max", "acceleration", "tilt_max", "gap_min", "yaw_max")
"""Limits that robots report."""


def limits_of(world: World) -> LimitsData:
    """Return the limits of the shown robots (deg): those they report and those of the teacher, else the defaults."""
    told = {} if world.limits is None else {name: getattr(world.limits, name) for name in REPORTED}
    found = replace(ROBOT.limits, **{name: round(math.degrees(limit), 3) for name, limit in told.items()})
    given = [robot.status.speed_limit for robot in (world.sim, world.hw) if robot.status is not None]
    return replace(
        found, speed_max=min([found.speed_max, *(math.degrees(limit) for limit in given if limit > 0)])
    )


def way(start: ArmAngles, pose: SavedPose) -> float:
    """Return the angle (deg) of the arm that turns furthest."""
    return max(abs(goal - before) for goal, before in zip(pose.arms, start, strict=True))


def shortest(start: ArmAngles, pose: SavedPose, limits: LimitsData) -> float:
    """Return the shortest possible duration (s) of a pose that begins at `start`, in tenths of a second."""
    turned = way(start, pose)
    least_s = shortest_s(turned, limits.speed_max, limits.acceleration) if turned >= SAME_DEG else 0.0
    return math.ceil((least_s + SETTLE_S) * 10 - 1e-6) / 10


def comfortable(start: ArmAngles, pose: SavedPose, speed: float, limits: LimitsData) -> float:
    """Return the duration (s) of a new pose: about that of a motion with `speed` (deg/s), in half seconds."""
    least_s = shortest(start, pose, at_speed(limits, speed))
    return min(DURATION_MAX_S, max(1.0, math.ceil(least_s * 2) / 2))


def at_speed(limits: LimitsData, speed: float) -> LimitsData:
    """Return limits with another top speed (deg/s), as near to it as the limits allow."""
    return replace(limits, speed_max=min(max(speed, SLOWEST), limits.speed_max))


def timed(
    poses: Iterable[SavedPose], start: ArmAngles, limits: LimitsData, begin_s: float = 0.0
) -> list[ArmPose]:
    """Return the steps of a choreography from `start` (deg); the first one begins at `begin_s`."""
    steps, at_s, here = [], begin_s, start
    for pose in poses:
        speed = speed_for(way(here, pose), max(0.0, pose.duration_s - SETTLE_S), limits.acceleration)
        steps.append(ArmPose(at_s, *pose.arms, min(limits.speed_max, max(SLOWEST, speed))))
        at_s, here = at_s + pose.duration_s, ArmAngles(*pose.arms)
    return steps


def shortest_of(
    poses: tuple[SavedPose, ...], start: ArmAngles | None, limits: LimitsData, *, loop: bool
) -> list[float]:
    """Return the shortest possible duration (s) of each pose.

    `start`: arms (deg) before the first pose; None: unknown, so that of the first pose is 0, except in a loop.
    """
    found: list[float] = []
    for number, pose in enumerate(poses):
        before = [start] if number == 0 and start is not None else []
        if number or (loop and len(poses) > 1):
            before.append(ArmAngles(*poses[number - 1].arms))
        found.append(max((shortest(place, pose, limits) for place in before), default=0.0))
    return found


def too_short(
    poses: tuple[SavedPose, ...], start: ArmAngles | None, limits: LimitsData, *, loop: bool
) -> dict[int, float]:
    """Return what `shortest_of` does for each pose that cannot be reached in its duration, by its number."""
    least = shortest_of(poses, start, limits, loop=loop)
    return {
        number: least[number] for number, pose in enumerate(poses) if least[number] > pose.duration_s + 1e-6
    }


@lru_cache(maxsize=1024)
def beyond(arms: tuple[float, float, float], limits: LimitsData) -> Refused | None:
    """Return the refusal of a pose (arms in deg) that the limits do not allow; None if they allow it.

    The neck is that of the robot as it ships, because robots do not report theirs to the window: the robot itself
    checks poses and ways when the sequence is played.
    """
    try:
        _rules(limits).check_pose([math.radians(angle) for angle in arms])
    except Refused as refusal:
        return refusal
    return None


@lru_cache(maxsize=8)
def _rules(limits: LimitsData) -> MotionLimits:
    """Return the limits of a robot whose neck is that of the robot as it ships."""
    return MotionLimits(replace(ROBOT, limits=limits))


@lru_cache(maxsize=256)
def head_of(arms: tuple[float, float, float]) -> HeadAngles | None:
    """Return the orientation (deg) of the head; None if the rods do not fit these arms (deg)."""
    try:
        return HeadAngles(*map(math.degrees, NECK.forward([math.radians(angle) for angle in arms])))
    except (BeatrixError, ValueError, ArithmeticError):
        return None


def arms_of(head: HeadAngles) -> ArmAngles:
    """Return the arms (deg) of an orientation (deg); raises Refused if the rods do not reach it."""
    return ArmAngles(*(math.degrees(angle) for angle in NECK.inverse(*map(math.radians, head))))
