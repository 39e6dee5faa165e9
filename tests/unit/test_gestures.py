"""Shipped gestures: within the limits of robots, a few seconds long, from home to home, and of the right form."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from beatrix_zenoh.client.choreography import GESTURES, SHIPPED, Choreography, Pose, shipped
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion import robot_file
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.paths.path import check_choreography

HOME: Arms = (0.0, 0.0, 0.0)
FILES = sorted(Path(__file__).resolve().parents[2].glob("beatrix_zenoh/**/*.toml"))
ROBOTS = [robot_file.load(path) for path in FILES if "[limits]" in path.read_text(encoding="utf-8")]


def poses(gesture: str) -> list[Pose]:
    """Return the poses of a gesture, which turn the head."""
    steps = [pose for _, pose in shipped(gesture).steps]
    return [pose for pose in steps if isinstance(pose, Pose)]


def length(played: Choreography) -> float:
    """Return the time (s) from the start of a choreography to its end, if each pose begins when it may."""
    neck, limits, here, end_s = Neck(), MotionLimits(), HOME, 0.0
    for _, pose in played.steps:
        assert isinstance(pose, Pose)
        speed = math.radians(pose.speed)
        goal = neck.inverse(*(math.radians(angle) for angle in (pose.yaw, pose.pitch, pose.roll)))
        motion = limits.check_motion(here, HOME, goal, (speed, speed, speed), straight=True)
        end_s, here = max(end_s, pose.at) + motion.duration, goal
    return end_s


def swings(angles: list[float]) -> int:
    """Return how often an angle goes from one side of zero to the other."""
    sides = [angle > 0 for angle in angles if angle]
    return sum(one != other for one, other in itertools.pairwise(sides))


def test_every_gesture_has_a_file_and_every_file_but_the_demo_is_a_gesture() -> None:
    assert {entry.name.removesuffix(".csv") for entry in SHIPPED.iterdir()} == {*GESTURES, "demo"}


@pytest.mark.parametrize("gesture", GESTURES)
def test_a_gesture_lasts_a_few_seconds_from_home_to_home_at_the_default_speed(gesture: str) -> None:
    found = poses(gesture)
    assert [(pose.yaw, pose.pitch, pose.roll) for pose in (found[0], found[-1])] == [(0, 0, 0)] * 2
    assert max(pose.speed for pose in found) == ROBOT.limits.speed_default
    assert 2 <= length(shipped(gesture)) <= 8


@pytest.mark.parametrize("gesture", GESTURES)
@pytest.mark.parametrize("robot", [ROBOT, *ROBOTS])
def test_a_gesture_is_within_the_limits_of_every_shipped_robot(gesture: str, robot: RobotData) -> None:
    assert ROBOTS, "lesson 6 ships a robot file"
    check_choreography(shipped(gesture), robot)


@given(
    gesture=st.sampled_from(GESTURES),
    tilt_max=st.floats(20, 44),
    yaw_max=st.floats(30, 180),
    gap_min=st.floats(30, 50),
    speed=st.floats(5, 90),
)
def test_a_gesture_is_within_narrower_limits_of_a_laboratory(
    gesture: str, tilt_max: float, yaw_max: float, gap_min: float, speed: float
) -> None:
    limits = replace(
        ROBOT.limits,
        tilt_max=tilt_max,
        yaw_max=yaw_max,
        gap_min=gap_min,
        speed_max=speed,
        speed_default=min(speed, 30.0),
    )
    check_choreography(shipped(gesture).at_most(limits.speed_default), replace(ROBOT, limits=limits))


@pytest.mark.parametrize("speed", [0.0, -1.0, math.nan])
def test_a_largest_speed_that_is_no_speed_is_refused(speed: float) -> None:
    with pytest.raises(WrongUsage):
        shipped("yes").at_most(speed)


FORMS: dict[str, Callable[[list[float], list[float], list[float]], bool]] = {
    "yes": lambda yaw, pitch, roll: swings(pitch) >= 3 and not any((*yaw, *roll)),
    "no": lambda yaw, pitch, roll: swings(yaw) >= 2 and not any((*pitch, *roll)),
    "hello": lambda yaw, pitch, roll: swings(roll) >= 2 and not any(yaw) and min(pitch) < 0,
    "surprised": lambda yaw, pitch, _roll: pitch[1] < -15 and swings(yaw) >= 1,
    "sleepy": lambda _yaw, pitch, roll: max(pitch) > 15 and max(roll) > 5 and swings(pitch) == 1,
    "curious": lambda yaw, _pitch, roll: swings(yaw) == swings(roll) == 1,
    "dance": lambda yaw, pitch, roll: min(map(swings, (yaw, pitch, roll))) >= 2,
}


@pytest.mark.parametrize("gesture", GESTURES)
def test_a_gesture_turns_the_head_as_people_do(gesture: str) -> None:
    found = poses(gesture)
    assert FORMS[gesture](
        [pose.yaw for pose in found], [pose.pitch for pose in found], [pose.roll for pose in found]
    )
