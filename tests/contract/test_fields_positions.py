"""Positions: the meaning of each published field, on every body."""

from __future__ import annotations

import itertools
import math
import statistics
import time

import pytest
from bodies import Body
from late_tests import in_time
from published import Published, published_positions
from robots import ask_raw, until

from beatrix_zenoh import Robot
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Head, Positions, Steps, Vector3
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck

POSE = (4.0, 14.0, -12.0)
"""Yaw, pitch and roll (deg) that turn the three arms by different angles, not all in one direction."""
SPEED = 20.0
FLOAT32 = 1e-6
"""Relative error of a number in single precision, with a margin."""


def arms(vector: Vector3) -> Arms:
    return vector.x, vector.y, vector.z


def counts(steps: Steps) -> tuple[int, int, int]:
    return steps.x, steps.y, steps.z


def angles(head: Head) -> Arms:
    return head.yaw, head.pitch, head.roll


def ask_positions(robot: Robot) -> Positions:
    """Query the newest positions."""
    (answer,) = ask_raw(robot.client, keys.positions(robot.name, robot.side))
    return codec.decode_json(answer.payload, Positions)


def arms_of_pose() -> Arms:
    """Return the arm angles of POSE (rad)."""
    yaw, pitch, roll = map(math.radians, POSE)
    return Neck().inverse(yaw, pitch, roll)


def constant_speed(samples: list[Positions], target: Arms) -> list[Positions]:
    """Return the samples from the middle of a motion from home, where all arms turn at a constant speed."""
    fastest = max(range(3), key=lambda arm: abs(target[arm]))
    return [at for at in samples if 0.25 < arms(at.commanded)[fastest] / target[fastest] < 0.85]


def slope(times: list[float], values: list[float]) -> float:
    """Return the change of a value per second, by least squares."""
    return statistics.linear_regression(times, values).slope


def look(robot: Robot) -> list[Positions]:
    """Move from home to POSE; return the positions published meanwhile."""
    positions = published_positions(robot)
    robot.look(*POSE, speed=SPEED)
    ended_ns = time.monotonic_ns()
    positions.next(lambda at: at.t_mono_ns > ended_ns)
    return positions.all


def test_velocity_is_the_change_of_position_with_time(robot: Robot) -> None:
    samples, target = look(robot), arms_of_pose()
    assert min(target) < 0 < max(target)
    longest = max(map(abs, target))
    middle = constant_speed(samples, target)
    times = [at.t_mono_ns / 1e9 for at in middle]
    for arm in range(3):
        expected = math.radians(SPEED) * target[arm] / longest
        # The simulated arms shake by 3 deg/s as the motors step, so the test compares means.
        near = pytest.approx(expected, abs=0.1 * abs(expected) + math.radians(2))
        assert statistics.mean(arms(at.velocity)[arm] for at in middle) == near
        assert slope(times, [arms(at.position)[arm] for at in middle]) == near
        assert slope(times, [arms(at.commanded)[arm] for at in middle]) == near


def test_steps_are_the_commanded_angles_in_microsteps(robot: Robot) -> None:
    gear = Gear()
    samples = look(robot)
    for at in samples:
        assert arms(at.commanded) == pytest.approx(gear.to_rad(counts(at.steps)), rel=FLOAT32, abs=FLOAT32)
    assert len({counts(at.steps) for at in samples}) > 10
    assert counts(ask_positions(robot).steps) == gear.to_steps(arms_of_pose())


def test_commanded_is_the_set_point_and_position_is_measured_or_counted(body: Body, robot: Robot) -> None:
    samples = look(robot)
    gaps = [abs(at.position.x - at.commanded.x) for at in samples]
    if body.side == "hw":
        assert all(at.position == at.commanded for at in samples), "counted steps"
    else:
        assert 0 < max(gaps) < math.radians(3), "measured: near the set point, but not equal"
    goal = arms_of_pose()
    step = math.tau / Gear().steps_per_turn
    assert arms(ask_positions(robot).commanded) == pytest.approx(goal, abs=step)
    until(
        lambda: arms(ask_positions(robot).position) == pytest.approx(goal, abs=math.radians(0.25)),
        "the arms at rest at the goal",
    )


def test_head_is_forward_kinematics_of_position(robot: Robot) -> None:
    neck = Neck()
    samples = look(robot)
    for at in samples:
        assert angles(at.head) == pytest.approx(neck.forward(arms(at.position)), abs=1e-5)
    assert angles(samples[-1].head) == pytest.approx(tuple(map(math.radians, POSE)), abs=math.radians(1))


def test_head_measured_is_missing_on_hardware(body: Body, robot: Robot) -> None:
    for at in look(robot):
        if body.side == "hw":
            assert at.head_measured is None
        elif at.head_measured is not None:
            assert angles(at.head_measured) == pytest.approx(angles(at.head), abs=math.radians(0.5))


def one_second(positions: Published[Positions]) -> list[Positions]:
    first = positions.next()
    positions.next(lambda at: at.t_mono_ns >= first.t_mono_ns + 1e9)
    return positions.all


def test_seq_counts_publications_and_a_query_returns_the_newest(robot: Robot) -> None:
    positions = published_positions(robot)
    queried = []
    for _ in range(5):
        before = positions.all[-1].seq
        queried.append(ask_positions(robot).seq)
        assert before <= queried[-1]
    numbers = [at.seq for at in one_second(positions)]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert set(queried) <= set(numbers)


def test_a_publication_repeats_a_time_stamp_only_with_the_mark(robot: Robot) -> None:
    samples = one_second(published_positions(robot))
    for before, at in itertools.pairwise(samples):
        assert at.repeated == (at.t_mono_ns == before.t_mono_ns)
        if at.repeated:
            assert (at.t_wall_ns, at.steps) == (before.t_wall_ns, before.steps)
    assert not ask_positions(robot).repeated


@pytest.mark.measures_time
def test_positions_are_published_at_50_hz(robot: Robot) -> None:
    samples = one_second(published_positions(robot))
    lasted_s = (samples[-1].t_mono_ns - samples[0].t_mono_ns) / 1e9
    due_s = (len(samples) - 1) / keys.POSITIONS_HZ
    assert lasted_s > due_s / 1.2
    in_time(lasted_s, due_s / 0.8, f"{len(samples)} samples at 50 Hz")


def test_time_stamps_never_decrease_and_are_by_the_clocks_of_this_computer(body: Body, robot: Robot) -> None:
    began_ns, began_wall_ns = time.monotonic_ns(), time.time_ns()
    positions = published_positions(robot)
    samples = list(one_second(positions))
    ended_ns, ended_wall_ns = time.monotonic_ns(), time.time_ns()
    stamps = [at.t_mono_ns for at in samples]
    assert stamps == sorted(stamps)
    if body.kind != "mega":  # it simulates every cycle, and sends less telemetry on a busy computer
        assert len(set(stamps)) > 0.8 * len(stamps)
    assert began_ns - 0.1e9 < stamps[0] <= stamps[-1] <= ended_ns, "not later than now, and not old"
    assert ended_ns - stamps[-1] < 0.5e9
    assert began_wall_ns - 0.1e9 < samples[0].t_wall_ns <= samples[-1].t_wall_ns <= ended_wall_ns
    offsets = [at.t_wall_ns - at.t_mono_ns for at in samples]
    assert max(offsets) - min(offsets) < 20e6, "both clocks are read at the same moment"


def test_a_relative_pose_adds_to_yaw_pitch_and_roll(robot: Robot) -> None:
    robot.look(8, 5, -6, speed=60)
    robot.look(3, -4, 2, relative=True, speed=60)
    yaw, pitch, roll = Neck().forward(arms(ask_positions(robot).commanded))
    # Both poses are rounded to whole microsteps, so their sum is not exact.
    assert tuple(map(math.degrees, (yaw, pitch, roll))) == pytest.approx((11, 1, -4), abs=0.4)
