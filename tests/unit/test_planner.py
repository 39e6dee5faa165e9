"""Planning: refusals with alternatives that are accepted, and the units of the firmware."""

from __future__ import annotations

import math
import re
import struct

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from msgspec import structs

from beatrix_zenoh import Refused
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    Alternative,
    Detail,
    Limit,
    MotionQuery,
    PoseQuery,
    Reason,
    Vector3,
)
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.motion.rotation import leaning
from beatrix_zenoh.node.planner import Planner

PLANNER = Planner(ROBOT)


def at(steps: int) -> Telemetry:
    """Return telemetry of a board whose arms rest at this step count."""
    return Telemetry(0, 1, 3, 0, 0, (steps, steps, steps), (0, 0, 0), 0, 0)


def detail_of(refusal: Refused) -> Detail:
    assert refusal.detail is not None
    return refusal.detail


def refusal_of(query: MotionQuery | PoseQuery, telemetry: Telemetry) -> Refused | None:
    try:
        PLANNER.goal(query, telemetry)
    except Refused as refusal:
        return refusal
    return None


def followed(query: MotionQuery | PoseQuery, other: Alternative) -> list[MotionQuery | PoseQuery]:
    """Return the requests that an alternative describes, after encoding and decoding."""
    requests: list[MotionQuery | PoseQuery] = []
    if other.speed is not None:
        if isinstance(query, PoseQuery):
            assert other.speed.x == other.speed.y == other.speed.z
            requests.append(structs.replace(query, speed=other.speed.x))
        else:
            requests.append(structs.replace(query, speed=other.speed))
    if other.head is not None:
        yaw, pitch, roll = other.head.yaw, other.head.pitch, other.head.roll
        requests.append(structs.replace(query, absolute=True, yaw=yaw, pitch=pitch, roll=roll))
    if other.arms is not None:
        speed = Vector3(*(query.speed,) * 3) if isinstance(query.speed, float) else query.speed
        requests.append(MotionQuery(position=other.arms, speed=speed))
    return [codec.decode(codec.encode(request), type(request)) for request in requests]


def single(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, width=32)


rates = st.one_of(single(0.125, 1.5), single(0.0003662109375, 0.0078125), single(1.5, 4.0), single(-1.0, 0.0))
vectors = st.builds(Vector3, single(-2, 2), single(-2, 2), single(-2, 2))
queries = st.one_of(
    st.builds(
        MotionQuery,
        absolute=st.booleans(),
        position=st.one_of(vectors, st.builds(Vector3, *(single(-8, 8),) * 3)),
        speed=st.none() | st.builds(Vector3, rates, rates, rates),
    ),
    st.builds(
        PoseQuery,
        absolute=st.booleans(),
        yaw=single(-8, 8),
        pitch=single(-1.5, 1.5),
        roll=single(-1.5, 1.5),
        speed=st.none() | rates,
    ),
)


@st.composite
def boards(draw: st.DrawFn) -> Telemetry:
    """Strategy for telemetry of a board whose arms are in an allowed pose and may be moving."""
    direction, tilt = draw(st.floats(0, math.tau)), draw(st.floats(0, 0.6))
    arms = PLANNER.neck.inverse(draw(st.floats(-3, 3)), *leaning(tilt, direction))
    velocity = draw(st.just((0, 0, 0)) | st.tuples(*(st.integers(-1000, 1000),) * 3))
    return structs.replace(at(0), position=PLANNER.gear.to_steps(arms), velocity=velocity)


SLOW = MotionQuery(position=Vector3(-0.808, -0.0508, -0.5168), speed=Vector3(0.00109, 0.000731, 0.000864))
MOVING = structs.replace(at(0), position=(797, 905, 1051), velocity=(-413, -475, 492))


@pytest.mark.no_cover
@settings(max_examples=30)
@given(queries, boards())
@example(SLOW, MOVING)
def test_every_alternative_is_accepted(query: MotionQuery | PoseQuery, board: Telemetry) -> None:
    refusal = refusal_of(query, board)
    if refusal is None:
        return
    detail = detail_of(refusal)
    assert detail.limit is not None
    if detail.value is not None:
        within = (-math.inf if detail.low is None else detail.low) <= detail.value
        assert not (within and detail.value <= (math.inf if detail.high is None else detail.high))
    if detail.alternative is not None:
        for request in followed(query, detail.alternative):
            assert refusal_of(request, board) is None, (detail.alternative, request)


@pytest.mark.no_cover
@settings(max_examples=30)
@given(queries, boards())
def test_the_rounded_numbers_in_a_sentence_are_accepted(
    query: MotionQuery | PoseQuery, board: Telemetry
) -> None:
    """A person types the rounded degrees of the sentence, not the radians of the detail."""
    refusal = refusal_of(query, board)
    if refusal is None or "Try " not in refusal.message:
        return
    advice = refusal.message.partition("Try ")[2]
    x, *rest = [math.radians(float(number)) for number in re.findall(r"-?\d+\.\d+", advice)]
    y, z = rest or (x, x)
    if "yaw" in advice:
        query = structs.replace(query, absolute=True, yaw=x, pitch=y, roll=z)
    elif "arms" in advice:
        query = structs.replace(query, absolute=True, position=Vector3(x, y, z))
    elif isinstance(query, PoseQuery):
        query = structs.replace(query, speed=x)
    else:
        query = structs.replace(query, speed=Vector3(x, y, z))
    assert refusal_of(codec.decode(codec.encode(query), type(query)), board) is None, refusal.message


@pytest.mark.parametrize(
    ("pose", "limit", "head"),
    [
        ((0, 40, 0), Limit.TILT, (0, 35, 0)),
        ((0, -80, 0), Limit.TILT, (0, -35, 0)),
        ((10, 179, 0), Limit.TILT, (10, 35, 0)),
        ((-20, 0, 50), Limit.TILT, (-20, 0, 35)),
        ((0, 200, 0), Limit.TILT, (0, 35, 0)),
        ((0, -200, 0), Limit.TILT, (0, -35, 0)),
        ((0, 0, 200), Limit.TILT, (0, 0, 35)),
        ((0, 100, 10), Limit.TILT, (0, 35, 0)),
        ((200, 0, 0), Limit.YAW, (180, 0, 0)),
        ((-500, 10, 0), Limit.YAW, (-180, 10, 0)),
    ],
)
def test_the_alternative_of_a_refused_pose_is_the_nearest_allowed_pose(
    pose: tuple[float, ...], limit: Limit, head: tuple[float, ...]
) -> None:
    yaw, pitch, roll = map(math.radians, pose)
    refusal = refusal_of(PoseQuery(yaw=yaw, pitch=pitch, roll=roll), at(0))
    assert refusal is not None
    detail = detail_of(refusal)
    assert (detail.limit, detail.at_goal) == (limit, True)
    assert detail.alternative is not None
    other = detail.alternative.head
    assert other is not None
    assert [math.degrees(angle) for angle in (other.yaw, other.pitch, other.roll)] == pytest.approx(head)


@pytest.mark.parametrize(
    ("turn", "teacher", "asked", "text"),
    [
        (40.0, 0.0, 80.0, "in this turn at most 40.0°/s is allowed. Try a speed of 40.0°/s."),
        (40.0, 60.0, 80.0, "in this turn at most 40.0°/s is allowed."),
        (0.0, 12.5, 60.0, "the teacher's limit of 12.5°/s applies. Try a speed of 12.5°/s."),
        (40.0, 20.0, 80.0, "the teacher's limit of 20.0°/s applies."),
        (
            31.0,
            31.0,
            80.0,
            "teacher and turn both limit it to 31.0°/s. Try a speed of 31.0°/s.",
        ),
        (0.0, 90.0, 100.0, "°/s to 90.0°/s is allowed."),
        (90.0, 90.0, 100.0, "°/s to 90.0°/s is allowed."),
    ],
)
def test_the_refusal_of_a_speed_names_the_lowest_limits(
    turn: float, teacher: float, asked: float, text: str
) -> None:
    """A limit that is as high as the robot's own is not named, because its end would permit nothing more."""
    planner = Planner(ROBOT)
    (sent,) = struct.unpack("<f", struct.pack("<f", math.radians(turn)))
    planner.limit_speed(math.radians(teacher))
    planner.limit_turn(sent)
    with pytest.raises(Refused) as refused:
        planner.goal(PoseQuery(yaw=0.1, speed=math.radians(asked)), at(0))
    assert text in refused.value.message
    other = detail_of(refused.value).alternative
    assert other is not None
    assert other.speed is not None
    planner.goal(PoseQuery(yaw=0.1, speed=other.speed.x), at(0))


@pytest.mark.parametrize("steps", [40_000, -40_000])
def test_step_counts_beyond_the_range_of_a_move_are_refused_with_advice(steps: int) -> None:
    little = MotionQuery(absolute=False, position=Vector3(0.0, 0.0, 0.0))
    with pytest.raises(Refused, match="calibrate") as refusal:
        PLANNER.goal(little, at(steps))
    detail = detail_of(refusal.value)
    assert (refusal.value.reason, detail.limit, detail.at_goal) == (Reason.BAD_VALUE, Limit.TRAVEL, True)
    assert detail.value == pytest.approx(40_000 / PLANNER.gear.steps_per_turn * math.tau)
    assert detail.high == pytest.approx(32_767 / PLANNER.gear.steps_per_turn * math.tau)


def test_the_checked_path_has_the_rounded_speeds_of_the_frame() -> None:
    """Rounding the speeds of slow arms changes their path: while it was not checked, the head tilted by 40 deg."""
    quarter = PLANNER.gear.quarters_to_speed((1, 1, 1))[0]
    speed = Vector3(7.87 * quarter, 5.58 * quarter, 3.44 * quarter)
    goal = PLANNER.goal(MotionQuery(position=Vector3(0.2, -0.1, -0.15), speed=speed), at(0))
    assert goal.quarters == (7, 5, 3)
    velocities = [section.velocity for section in goal.trajectory.sections]
    fastest = [max(abs(velocity[arm]) for velocity in velocities) for arm in range(3)]
    assert fastest == pytest.approx([7 * quarter, 5 * quarter, 3 * quarter])


# -- the frame of a goal --------------------------------------------------------------------------


def test_the_slowest_speed_is_a_quarter_of_a_microstep_per_second() -> None:
    slowest = PLANNER.gear.quarters_to_speed((1, 1, 1))[0]
    step = math.tau / PLANNER.gear.steps_per_turn
    assert PLANNER.goal(PoseQuery(yaw=step, speed=slowest), at(0)).quarters == (1, 1, 1)
    refusal = refusal_of(PoseQuery(yaw=step, speed=0.9 * slowest), at(0))
    assert refusal is not None
    assert refusal.reason is Reason.SPEED_LIMIT


TENTH = Vector3(0.1, 0.1, 0.1)


STEPS = PLANNER.gear.to_steps((0.1, 0.1, 0.1))


DEFAULT = math.radians(ROBOT.limits.speed_default)


@pytest.mark.parametrize(
    ("query", "kind", "speeds"),
    [
        (MotionQuery(position=TENTH), Move, (DEFAULT,) * 3),
        (MotionQuery(position=TENTH, speed=Vector3(0.2, 0.3, 0.4)), Move, (0.2, 0.3, 0.4)),
        (PoseQuery(yaw=0.1), MoveStraight, (DEFAULT,) * 3),
        (PoseQuery(yaw=0.1, speed=0.4), MoveStraight, (0.4, 0.4, 0.4)),
    ],
)
def test_the_frame_of_a_goal_has_whole_steps_and_the_requested_or_default_speed(
    query: MotionQuery | PoseQuery, kind: type[Move | MoveStraight], speeds: tuple[float, float, float]
) -> None:
    goal, quarters = PLANNER.goal(query, at(0)), PLANNER.gear.speed_to_quarters(speeds)
    assert goal.frame(9) == (
        Move(9, STEPS, quarters) if kind is Move else MoveStraight(9, STEPS, quarters[0])
    )
    assert goal.target == PLANNER.gear.to_rad(goal.steps)
    assert goal.duration == goal.trajectory.duration > 0
