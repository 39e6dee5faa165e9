"""Shipped gestures: within the limits of robots, a few seconds long, and from home to home."""

from __future__ import annotations

import math
import os
from pathlib import Path
from unittest.mock import MagicMock, Mock

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.client import motion_file
from beatrix_zenoh.client.choreography import (
    GESTURES,
    SHIPPED,
    ArmPose,
    Choreography,
    Pose,
    choreography,
    load,
    play,
    shipped,
)
from beatrix_zenoh.contract._generated.messages import MotionQuery, PoseQuery, Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion import robot_file
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.paths.path import check_choreography

HOME: Arms = (0.0, 0.0, 0.0)
FILES = sorted(Path(__file__).resolve().parents[2].glob("beatrix_zenoh/**/*.toml"))
ROBOTS = [robot_file.load(path) for path in FILES if "[limits]" in path.read_text(encoding="utf-8")]


def poses(gesture: str) -> list[Pose]:
    """Return the poses of a gesture, which turn the head."""
    steps = [pose for _, pose in shipped(gesture).steps]
    return [pose for pose in steps if isinstance(pose, Pose)]


def length(poses: list[Pose]) -> float:
    """Return the time (s) from the start of a choreography to its end, if each pose begins when it may."""
    limits, here, end_s = MotionLimits(), HOME, 0.0
    for pose in poses:
        speed = math.radians(pose.speed)
        goal = limits.arms_of_head(*(math.radians(angle) for angle in (pose.yaw, pose.pitch, pose.roll)))
        motion = limits.check_motion(here, HOME, goal, (speed, speed, speed), straight=True)
        end_s, here = max(end_s, pose.at) + motion.duration, goal
    return end_s


def test_every_gesture_has_a_file_and_every_file_but_the_demo_is_a_gesture() -> None:
    assert {entry.name.removesuffix(".csv") for entry in SHIPPED.iterdir()} == {*GESTURES, "demo"}


@pytest.mark.parametrize("gesture", GESTURES)
def test_a_gesture_lasts_a_few_seconds_from_home_to_home_at_the_default_speed(gesture: str) -> None:
    found = poses(gesture)
    assert [(pose.yaw, pose.pitch, pose.roll) for pose in (found[0], found[-1])] == [(0, 0, 0)] * 2
    assert max(pose.speed for pose in found) == ROBOT.limits.speed_default
    assert 2 <= length(found) <= 8


def test_the_demo_lasts_ten_seconds() -> None:
    assert 9 < length(poses("demo")) < 10


@pytest.mark.parametrize("gesture", [*GESTURES, "demo"])
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


# -- choreographies: file contents, and the order of poses ------------------------------------------


HEAD = "t_s,yaw_deg,pitch_deg,roll_deg,short_deg,middle_deg,long_deg,speed_deg_s,figure\n"
ROWS = HEAD + "0,0,5,0,,,,60,nod\n1.5,,,,10,-5,0,,\n2,1,0,0,,,,30,shake\n"


def test_a_line_of_a_choreography_turns_the_head_or_the_arms() -> None:
    steps = choreography(motion_file.parse(ROWS, "mine")).steps
    assert steps == [
        ("nod", Pose(0, 0, 5, 0, 60)),
        ("nod", ArmPose(1.5, 10, -5, 0, 60)),
        ("shake", Pose(2, 1, 0, 0, 30)),
    ]
    head, arms = (pose.query() for _, pose in steps[:2])
    assert isinstance(head, PoseQuery)
    assert (head.absolute, head.pitch, head.speed) == (True, math.radians(5), math.radians(60))
    assert isinstance(arms, MotionQuery)
    assert (arms.absolute, arms.position.x) == (True, math.radians(10))
    assert [str(pose) for _, pose in steps[:2]] == [
        "yaw +0°, pitch +5°, roll +0°",
        "arms short +10°, middle -5°, long +0°",
    ]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("t_s,yaw_deg,pitch_deg,roll_deg\n0,1,2,3\n", "`beatrix replay`"),
        (HEAD + "0,0,5,0,,,,,nod\n", "mine.csv, line 2: speed_deg_s is empty"),
        (
            HEAD + "0,0,5,0,,,,0,nod\n",
            "mine.csv, line 2: speed_deg_s is 0: give a number of degrees/s above 0",
        ),
    ],
)
def test_a_file_that_is_no_choreography_is_refused(text: str, what: str) -> None:
    with pytest.raises(WrongUsage) as refusal:
        choreography(motion_file.parse(text, "mine.csv"))
    assert what in refusal.value.message


def test_a_file_is_read_and_a_shipped_one_is_found_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(ROWS, encoding="utf-8")
    assert len(load(path).steps) == 3
    assert load(Path("hello")) == shipped("hello")
    names = ", ".join(sorted((*GESTURES, "demo")))
    with pytest.raises(WrongUsage, match=f"or a shipped choreography: {names}"):
        load(tmp_path / "yours.csv")
    with pytest.raises(WrongUsage, match="not a regular file"):
        load(Path(os.devnull))


TWO_POSES = Choreography([("f", Pose(0.0, 1.0, 0, 0, 60.0)), ("f", Pose(0.02, 2.0, 0, 0, 60.0))])


def test_a_stopped_robot_ends_the_play(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beatrix_zenoh.client.choreography.StopEvents", Mock())
    robot = MagicMock(Robot, __str__=lambda _: "bea (sim)")
    robot.begin.return_value.exception.return_value = Interrupted(Reason.STOPPED, "Ended by STOP.")
    with pytest.raises(Interrupted, match=r"bea \(sim\): Ended by STOP"):
        play(robot, TWO_POSES)
    robot.begin.assert_called_once()
    with pytest.raises(WrongUsage, match="only for both robots"):
        play(robot, TWO_POSES, lead_s=1.0)


# -- check ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "where", "reason"),
    [
        ("0,0,60,0,,,,40\n", r"line 2 \(t = 0\.00 s\): The head would lean", Reason.OUT_OF_REACH),
        ("0,0,5,0,,,,40\n1,0,60,0\n", r"line 3 \(t = 1\.00 s\): The head would lean", Reason.OUT_OF_REACH),
        ("0,0,5,0,,,,40\n\n1,190,0,0\n", r"line 4 \(t = 1\.00 s\): The head would", Reason.YAW_LIMIT),
        ("0,0,5,0,,,,40\n1,,,,0,0,300\n", r"line 3 \(t = 1\.00 s\): ", None),
        ("0,0,5,0,,,,40\n1,0,0,0,,,,500\n", r"line 3 \(t = 1\.00 s\): ", Reason.SPEED_LIMIT),
    ],
)
def test_a_choreography_is_refused_as_a_whole_with_line_and_time(
    text: str, where: str, reason: Reason | None
) -> None:
    found = choreography(motion_file.parse(HEAD + text, "mine.csv"))
    with pytest.raises(Refused, match=f"mine.csv, {where}") as refused:
        check_choreography(found, ROBOT)
    assert reason in (None, refused.value.reason)
