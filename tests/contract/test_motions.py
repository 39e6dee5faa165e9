"""Motions: every body gives the same replies and set points for the same requests."""

from __future__ import annotations

import math

import pytest
from bodies import EVERY
from late_tests import in_time
from robots import ask_raw, assert_fails, raw_positions, turning, until

from beatrix_zenoh import Interrupted, Refused, Robot, suggestion
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import MotionReply, Phase, PoseQuery, Reason
from beatrix_zenoh.motion.gear import Gear
from beatrix_zenoh.motion.kinematics import Neck

pytestmark = pytest.mark.bodies(*EVERY)
STEP_DEG = 360 / Gear().steps_per_turn
MEASURED_DEG = 0.25


def assert_rests_at(robot: Robot, arms: tuple[float, float, float]) -> None:
    """Assert that commanded angles are within a step at once, and measured ones within 0.25 deg when the head rests."""
    assert robot.positions().commanded == pytest.approx(arms, abs=STEP_DEG)
    until(lambda: robot.positions().arms == pytest.approx(arms, abs=MEASURED_DEG), f"measured arms at {arms}")


def test_an_absolute_motion_ends_at_the_target(robot: Robot) -> None:
    robot.move(10, -5, 3, speed=60)
    assert_rests_at(robot, (10, -5, 3))


def test_a_relative_motion_starts_from_the_set_point(robot: Robot) -> None:
    robot.move(4, 4, 4, speed=60)
    robot.move(1, -2, 0, relative=True, speed=60)
    assert_rests_at(robot, (5, 2, 4))


def test_look_turns_the_head_to_the_pose(robot: Robot) -> None:
    robot.look(yaw=15, pitch=-8, roll=5, speed=60)
    wanted = Neck().inverse(*map(math.radians, (15, -8, 5)))
    short, middle, long = map(math.degrees, wanted)
    assert_rests_at(robot, (short, middle, long))
    until(lambda: robot.positions().head == pytest.approx((15, -8, 5), abs=0.4), "head at the pose")


@pytest.mark.measures_time
def test_a_motion_gets_two_replies_accepted_and_done(robot: Robot) -> None:
    key = keys.pose(robot.name, robot.side, "ana")
    replies = ask_raw(robot.client, key, codec.encode(PoseQuery(yaw=0.1)), codec.MSGPACK)
    accepted, done = (codec.decode(reply.payload, MotionReply) for reply in replies)
    assert (accepted.phase, accepted.result, done.phase, done.result) == (
        Phase.ACCEPTED,
        True,
        Phase.DONE,
        True,
    )
    assert accepted.motion == done.motion > 0
    assert done.position.x == pytest.approx(0.1, abs=math.radians(STEP_DEG))
    in_time(abs(done.duration - accepted.duration), 0.15, "duration apart from the one announced")


def test_a_newer_motion_replaces_the_running_one(robot: Robot) -> None:
    first = robot.look(yaw=40, wait=False)
    robot.look(yaw=-5, speed=60)
    assert_fails(first.wait, Interrupted, Reason.REPLACED)
    assert_rests_at(robot, (-5, -5, -5))


@pytest.mark.bodies(*EVERY, safety=True)
def test_the_reply_to_stop_has_the_exact_rest_position(robot: Robot) -> None:
    motion = turning(robot)
    reply = robot.stop()
    rest = raw_positions(robot)
    assert "rest at" in reply.message
    assert reply.position == rest.commanded
    assert Gear().to_steps((rest.commanded.x, rest.commanded.y, rest.commanded.z)) == (
        rest.steps.x,
        rest.steps.y,
        rest.steps.z,
    )
    assert math.degrees(reply.position.x) < 30
    assert_fails(motion.wait, Interrupted, Reason.STOPPED)
    assert not robot.status().moving


REFUSALS = [
    ((120.0, 0.0, 0.0), 30.0, Reason.ARM_GAP, "30.0°"),
    ((200.0, 200.0, 200.0), 30.0, Reason.YAW_LIMIT, "180"),
    ((5.0, 0.0, 0.0), 0.0, Reason.SPEED_LIMIT, "speed"),
    ((5.0, 0.0, 0.0), 1000.0, Reason.SPEED_LIMIT, "90"),
    ((math.nan, 0.0, 0.0), 30.0, Reason.BAD_VALUE, "finite"),
]


@pytest.mark.bodies("in-process")
@pytest.mark.parametrize(("arms", "speed", "reason", "word"), REFUSALS)
def test_an_impossible_motion_is_refused_and_nothing_moves(
    robot: Robot, arms: tuple[float, float, float], speed: float, reason: Reason, word: str
) -> None:
    before = raw_positions(robot).steps
    with pytest.raises(Refused) as refusal:
        robot.move(*arms, speed=speed)
    assert refusal.value.reason is reason
    assert word in refusal.value.message.lower()
    assert raw_positions(robot).steps == before
    assert not robot.status().moving


def test_the_suggestion_of_a_refusal_is_accepted(robot: Robot) -> None:
    with pytest.raises(Refused) as refusal:
        robot.look(pitch=60)
    offer = suggestion(refusal.value)
    assert offer is not None
    assert offer.head is not None
    assert offer.head.pitch == pytest.approx(35, abs=0.5)
    robot.look(*offer.head, speed=60)
    assert suggestion(Refused(Reason.BUSY)) is None
