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
from robots import raw_positions, until

from beatrix_zenoh import Robot
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


def test_fields_during_a_motion(body: Body, robot: Robot) -> None:
    samples = look(robot)
    assert_velocity_is_the_change_of_position(samples)
    gear, neck, goal = Gear(), Neck(), arms_of_pose()
    for at in samples:
        assert arms(at.commanded) == pytest.approx(gear.to_rad(counts(at.steps)), rel=FLOAT32, abs=FLOAT32)
        assert angles(at.head) == pytest.approx(neck.forward(arms(at.position)), abs=1e-5)
        if body.side == "hw":
            assert at.position == at.commanded, "counted steps"
            assert at.head_measured is None
    assert len({counts(at.steps) for at in samples}) > 10
    assert counts(raw_positions(robot).steps) == gear.to_steps(goal)
    assert arms(raw_positions(robot).commanded) == pytest.approx(goal, abs=math.tau / gear.steps_per_turn)


def assert_velocity_is_the_change_of_position(samples: list[Positions]) -> None:
    target = arms_of_pose()
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


@pytest.mark.bodies("sim")
def test_a_simulation_measures_its_position_and_head(robot: Robot) -> None:
    samples = look(robot)
    gaps = [abs(at.position.x - at.commanded.x) for at in samples]
    assert 0 < max(gaps) < math.radians(3), "near the set point, but not equal"
    for at in samples:
        if at.head_measured is not None:
            assert angles(at.head_measured) == pytest.approx(angles(at.head), abs=math.radians(0.5))
    assert any(at.head_measured is not None for at in samples)
    until(
        lambda: arms(raw_positions(robot).position) == pytest.approx(arms_of_pose(), abs=math.radians(0.25)),
        "the arms at rest at the goal",
    )


def one_second(positions: Published[Positions]) -> list[Positions]:
    first = positions.next()
    positions.next(lambda at: at.t_mono_ns >= first.t_mono_ns + 1e9)
    return positions.all


@pytest.mark.measures_time
def test_number_and_times_of_publications(body: Body, robot: Robot) -> None:
    began_ns, began_wall_ns = time.monotonic_ns(), time.time_ns()
    positions = published_positions(robot)
    queried = []
    for _ in range(5):
        before = positions.all[-1].seq
        queried.append(raw_positions(robot))
        assert before <= queried[-1].seq, "a query returns the newest"
    samples = list(one_second(positions))
    ended_ns, ended_wall_ns = time.monotonic_ns(), time.time_ns()
    numbers = [at.seq for at in samples]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert {at.seq for at in queried} <= set(numbers)
    assert not any(at.repeated for at in queried)
    for one, two in itertools.pairwise(samples):
        assert two.repeated == (two.t_mono_ns == one.t_mono_ns)
        if two.repeated:
            assert (two.t_wall_ns, two.steps) == (one.t_wall_ns, one.steps)
    stamps = [at.t_mono_ns for at in samples]
    assert stamps == sorted(stamps)
    assert began_ns - 0.1e9 < stamps[0] <= stamps[-1] <= ended_ns, "not later than now, and not old"
    assert began_wall_ns - 0.1e9 < samples[0].t_wall_ns <= samples[-1].t_wall_ns <= ended_wall_ns
    in_time((ended_ns - stamps[-1]) / 1e9, 0.5, "age of the newest positions")
    offsets = [at.t_wall_ns - at.t_mono_ns for at in samples]
    in_time((max(offsets) - min(offsets)) / 1e9, 0.02, "between the readings of both clocks")
    lasted_s, due_s = (stamps[-1] - stamps[0]) / 1e9, (len(samples) - 1) / keys.positions.rate_hz
    assert lasted_s > due_s / 1.2
    in_time(lasted_s, due_s / 0.8, f"{len(samples)} samples at 50 Hz")
    if body.kind != "mega":  # it simulates every cycle, and sends less telemetry on a busy computer
        in_time(lasted_s, len(set(stamps)) / keys.positions.rate_hz / 0.7, "telemetry behind these samples")
