"""Paths and their targets: smooth, checked in advance, and followed closely."""

from __future__ import annotations

import math
import re
import time
from typing import cast
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from beatrix_zenoh import Interrupted, Refused, Robot
from beatrix_zenoh.client import motion_file
from beatrix_zenoh.client.robot_base import Offset
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.limits import MotionLimits
from beatrix_zenoh.motion.trajectory import plan
from beatrix_zenoh.paths.follow import LEAD_IN_S, STEP_S, Following, follow
from beatrix_zenoh.paths.path import ArmPath, Floats, path_of, path_of_recording
from beatrix_zenoh.paths.replay import LATE_S, TargetStream

REST: Arms = (0.0, 0.0, 0.0)
HEADER = "# mine\nt_s,yaw_deg,pitch_deg,roll_deg\n"
ANGLES = st.floats(-400, 400)
LIMITS = MotionLimits()


def path(text: str) -> ArmPath:
    """Return a path of the head; each line of `text` is a point: time (s), yaw, pitch and roll (deg)."""
    return path_of(motion_file.parse(HEADER + text, "mine.csv"), LIMITS)


# -- paths --------------------------------------------------------------------------------------


@st.composite
def points(draw: st.DrawFn) -> tuple[Floats, Floats]:
    """Strategy for times (s) and arms (deg) of a path."""
    steps = draw(st.lists(st.floats(0.01, 5.0), min_size=1, max_size=12))
    arms = draw(st.lists(st.tuples(ANGLES, ANGLES, ANGLES), min_size=len(steps) + 1, max_size=len(steps) + 1))
    return np.concatenate(([0.0], np.cumsum(steps))), np.array(arms)


@pytest.mark.no_cover
@given(points())
def test_a_path_goes_through_its_points_and_never_beyond_them(given_points: tuple[Floats, Floats]) -> None:
    t, arms = given_points
    found = ArmPath("mine", t, arms)
    assert found.at(t) == pytest.approx(arms, abs=1e-6)
    for i in range(len(t) - 1):
        between = found.at(np.linspace(t[i], t[i + 1], 20))
        low, high = np.minimum(arms[i], arms[i + 1]), np.maximum(arms[i], arms[i + 1])
        assert (between >= low - 1e-6).all()
        assert (between <= high + 1e-6).all()
    assert found.at(np.array([-1.0, t[-1] + 1.0])) == pytest.approx(arms[[0, -1]])


def test_the_times_of_a_path_begin_at_zero_and_its_points_keep_their_line_numbers() -> None:
    found = path("5,0,0,0\n6,10,0,0\n\n8,0,5,0\n")
    assert found.t.tolist() == [0, 1, 3]
    assert [found.where(t) for t in (0.0, 0.5, 1.0, 2.5, 9.0)] == [
        f"mine.csv, line {line} (t = {t:.2f} s)" for line, t in ((3, 5), (4, 5.5), (4, 6), (6, 7.5), (6, 14))
    ]
    assert found.at_speed(2.0).duration_s == 1.5
    assert found.at_speed(2.0).where(0.5) == found.where(1.0), "messages show the times of the file"
    for factor in (0.0, -1.0, 1e-300, 0.009, 101.0, math.nan, math.inf):
        with pytest.raises(WrongUsage, match=r"speed factor is .* from 0\.01 to 100"):
            found.at_speed(factor)


@pytest.mark.no_cover
@given(points(), st.floats(0.0, 0.99), st.sampled_from([1.0, 0.5, 3.0]))
def test_a_path_that_begins_later_leads_through_the_same_points(
    given_points: tuple[Floats, Floats], part: float, factor: float
) -> None:
    t, arms = given_points
    whole = ArmPath("mine", t, arms, tuple(range(2, len(t) + 2)), begin_s=7.0).at_speed(factor)
    given_s = 7.0 + part * t[-1]
    found = whole.beginning(given_s)
    skipped_s = whole.duration_s - found.duration_s
    assert whole.given_s(skipped_s) == pytest.approx(given_s)
    assert found.arms[0] == pytest.approx(whole.at(np.array([skipped_s]))[0])
    assert found.where(0.0) == whole.where(skipped_s + 1e-6)
    left = t[t > given_s - 7.0]
    assert found.at((left - given_s + 7.0) / factor) == pytest.approx(arms[-len(left) :], abs=1e-6)
    assert found.where(found.duration_s) == whole.where(whole.duration_s)


def test_a_path_that_is_too_long_is_refused_before_it_is_planned() -> None:
    hour = path("0,0,0,0\n3600,10,0,0\n")
    hour.check_length()
    with pytest.raises(WrongUsage, match=r"takes 7200 s at the speed factor 0\.5; at most 3600 s"):
        hour.at_speed(0.5)
    day = path("0,0,0,0\n86400,10,0,0\n")
    assert day.at_speed(100).duration_s == 864
    with pytest.raises(WrongUsage, match="takes 86400 s; at most"):
        follow(day, ROBOT)
    clock_was_set = np.array([0.0, 1.0, 1e12, 1e12 + 1])
    with pytest.raises(WrongUsage, match="its motions span 1000000000000 s; at most 86400 s"):
        path_of_recording("it", clock_was_set, np.outer([0.0, 10.0, 5.0, 0.0], np.ones(3)))


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("0,0,0,0\n", "has one point"),
        ("0,0,0,0\n1,5,0,0\n1,6,0,0\n", "mine.csv, line 5: t_s is 1, the same as in the line before"),
        *(
            (
                f"0,0,0,0\n1,0,{-tilt},0\n",
                f"mine.csv, line 4 (t = 1.00 s): The head would lean {tilt}.0°; at most 35.0° is allowed.",
            )
            for tilt in (36, 44, 46, 60, 89, 120)
        ),
    ],
)
def test_an_invalid_path_is_refused(text: str, what: str) -> None:
    with pytest.raises(Refused) as refusal:
        path(text)
    assert what in refusal.value.message


# -- targets ------------------------------------------------------------------------------------


def driven(following: Following) -> Floats:
    """Return the arms (n, 3; deg) of a robot that follows the targets as the firmware does, in steps of STEP_S."""
    position: Arms = cast("Arms", tuple(math.radians(angle) for angle in following.path.arms[0]))
    velocity, arms = REST, []
    ends = [target.t for target in following.targets[1:]] + [len(following.planned) * STEP_S - LEAD_IN_S]
    for target, end in zip(following.targets, ends, strict=True):
        goal, speed = target.query.position, target.query.speed
        assert speed is not None
        way = plan(
            position,
            velocity,
            (goal.x, goal.y, goal.z),
            (speed.x, speed.y, speed.z),
            math.radians(ROBOT.limits.acceleration),
            straight=False,
        )
        count = round((end - target.t) / STEP_S)
        arms += [way.at(step * STEP_S)[0] for step in range(count)]
        position, velocity = way.at(count * STEP_S)
    return np.degrees(arms)


HEADS = st.lists(
    st.tuples(st.floats(-60, 60), st.floats(-15, 15), st.floats(-15, 15)), min_size=2, max_size=4
)


def recorded(heads: list[tuple[float, float, float]], speed: float) -> ArmPath:
    """Return the path of a robot that looks in several directions at `speed` (deg/s), 20 points a second."""
    here, arms = REST, [REST] * 10
    for head in [*heads, (0.0, 0.0, 0.0)]:
        goal = LIMITS.arms_of_head(*(math.radians(angle) for angle in head))
        way = plan(here, REST, goal, (math.radians(speed),) * 3, math.radians(180), straight=True)
        arms += [way.at(k * 0.05)[0] for k in range(math.ceil(way.duration / 0.05) + 8)]
        here = goal
    return ArmPath("mine", np.arange(0.0, len(arms)) * 0.05, np.array(np.degrees(arms), dtype=np.float64))


@pytest.mark.no_cover
@given(HEADS, st.floats(10, 80))
@settings(max_examples=12, deadline=None)
def test_a_recorded_motion_is_followed_closely(heads: list[tuple[float, float, float]], speed: float) -> None:
    following = follow(recorded(heads, speed), ROBOT)
    assert following.off_deg < 0.5
    way = driven(following)
    assert way == pytest.approx(following.planned, abs=1e-3), "the targets give the planned path"
    assert way[-1] == pytest.approx(following.path.arms[-1], abs=0.02)
    assert following.at(0.015 - LEAD_IN_S) == pytest.approx((way[1] + way[2]) / 2, abs=1e-3)


@pytest.mark.no_cover
@given(st.floats(-1, 1), st.floats(0.5, 4.0))
@settings(max_examples=10, deadline=None)
def test_a_path_written_by_hand_is_followed_or_refused_with_its_line(yaw: float, seconds: float) -> None:
    assume(abs(yaw) > 0.1)
    text = f"0,0,0,0\n{seconds:.3f},{90 * yaw:.2f},0,0\n{2 * seconds:.3f},{90 * yaw:.2f},10,0\n"
    try:
        off_deg, refused = follow(path(text), ROBOT).off_deg, ""
    except Refused as refusal:
        off_deg, refused = 0.0, refusal.message
    assert off_deg <= 3
    assert not refused or re.match(r"mine\.csv, line [45] \(t = .*--speed-factor", refused)


# -- sending ------------------------------------------------------------------------------------


def test_a_suspended_program_sends_no_late_target(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("beatrix_zenoh.paths.replay.offset_of", lambda _robot: Offset(0.0, 0.0))
    monkeypatch.setattr("beatrix_zenoh.paths.replay.StopEvents", Mock())
    following = follow(path("0,0,0,0\n1,10,0,0\n"), ROBOT)
    stream = TargetStream(Mock(Robot, side="sim"), following, 0.0, None)
    stream.start(time.monotonic() - LATE_S - 0.1)
    with pytest.raises(Interrupted, match="was suspended") as error:
        stream.advance()
    assert error.value.reason is Reason.STOPPED
