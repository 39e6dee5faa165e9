"""The plant: accuracy, lost steps, another assembly, sleep; and the set points of its motors."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from bench_plant import angle_between, closure_error
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.trajectory import plan
from sim_node.plant import Plant, StepperDrive

GEAR = Gear()
NECK = Neck()
SPEED = math.radians(ROBOT.limits.speed_max)
ACCELERATION = math.radians(ROBOT.limits.acceleration)
STEP = 0.002
HOME: Arms = (0.0, 0.0, 0.0)


def ramp(start: Arms, goal: Arms) -> Iterator[Arms]:
    """Yield set points of the arms (rad) for each physics step, at full speed; all arms arrive at the same time."""
    way = plan(start, HOME, goal, (SPEED,) * 3, ACCELERATION, straight=True)
    for k in range(math.ceil(way.duration / STEP) + 1):
        yield way.at(k * STEP)[0]


def hold_set_points(plant: Plant, arms: Arms, seconds: float, *, drivers_on: bool = True) -> None:
    """Advance time with constant set points."""
    pulses = GEAR.to_steps(arms)
    for _ in range(round(seconds / STEP)):
        plant.step(pulses, drivers_on=drivers_on)


def go(plant: Plant, start: Arms, goal: Arms) -> None:
    """Move the arms to a goal at full speed, and wait until they rest."""
    for arms in ramp(start, goal):
        plant.step(GEAR.to_steps(arms), drivers_on=True)
    hold_set_points(plant, goal, 0.5)


def random_pose(rng: random.Random) -> Arms:
    """Return the arms (rad) of a random pose within the limits of the robot."""
    while True:
        pitch, roll = (math.radians(rng.uniform(-35, 35)) for _ in range(2))
        if math.acos(math.cos(pitch) * math.cos(roll)) > math.radians(ROBOT.limits.tilt_max):
            continue
        arms = NECK.inverse(math.radians(rng.uniform(-180, 180)), pitch, roll)
        if min(NECK.gaps(arms)) > math.radians(ROBOT.limits.gap_min):
            return arms


@pytest.fixture
def plant() -> Plant:
    return Plant()


TILTED = NECK.inverse(0.4, 0.3, 0.1)


def test_head_and_loop_are_accurate_in_random_motions_at_full_speed(plant: Plant) -> None:
    rng = random.Random(7)
    start = HOME
    for _ in range(5):
        goal = random_pose(rng)
        for k, arms in enumerate(ramp(start, goal)):
            plant.step(GEAR.to_steps(arms), drivers_on=True)
            assert closure_error(plant) < 0.05e-3
            assert plant.data.ncon == 0, "no part touches another"
            if k % 5 == 0:
                assert angle_between(plant, NECK) < 0.02
        hold_set_points(plant, goal, 0.5)
        start = goal
        off = [abs(a - s) for a, s in zip(plant.arms(), GEAR.to_rad(GEAR.to_steps(goal)), strict=True)]
        assert math.degrees(max(off)) < 0.25
    assert plant.drive.slipped == (0, 0, 0)
    assert not plant.home_assembly_left()


def test_the_head_is_measured_as_yaw_pitch_roll(plant: Plant) -> None:
    go(plant, HOME, TILTED)
    assert plant.head() == pytest.approx((0.4, 0.3, 0.1), abs=math.radians(0.3))
    assert math.cos(plant.tilt()) == pytest.approx(math.cos(0.3) * math.cos(0.1), abs=5e-3)
    assert plant.gap() == pytest.approx(min(NECK.gaps(TILTED)), abs=math.radians(0.5))


def test_a_push_above_the_motors_torque_loses_multiples_of_four_full_steps(plant: Plant) -> None:
    plant.data.body("head").xfrc_applied[5] = 3.5  # N m about the vertical
    hold_set_points(plant, HOME, 0.3)
    plant.data.body("head").xfrc_applied[5] = 0.0
    hold_set_points(plant, HOME, 0.5)
    lost = plant.drive.slipped
    assert all(steps % 4 == 0 and steps < 0 for steps in lost)
    assert not plant.home_assembly_left()
    turned = -lost[0] * math.radians(1.8) * 26 / 68
    assert plant.arms()[0] == pytest.approx(turned, abs=math.radians(0.1))
    assert angle_between(plant, NECK) < 0.02
    plant.straighten()
    assert plant.arms() == HOME
    assert plant.drive.slipped == (0, 0, 0)


def test_without_motors_a_tilted_head_sinks_and_the_loop_stays_closed(plant: Plant) -> None:
    go(plant, HOME, TILTED)
    tilt = plant.tilt()
    hold_set_points(plant, TILTED, 2.0, drivers_on=False)
    assert plant.tilt() > tilt + math.radians(10)
    assert not plant.home_assembly_left()


def test_another_assembly_is_detected_and_reassembled_at_the_set_points(plant: Plant) -> None:
    go(plant, HOME, TILTED)
    plant.data.joint("head").qpos = [0.0, 1.0, 0.0, 0.0]  # turned over, as if the linkage had snapped through
    assert plant.home_assembly_left()
    plant.reassemble()
    assert plant.re_placed == 1
    assert not plant.home_assembly_left()
    assert plant.arms() == pytest.approx(TILTED, abs=math.radians(0.1))
    assert closure_error(plant) < 1e-9
    assert angle_between(plant, NECK) < 1e-6


def test_nan_is_detected_and_no_file_is_written(
    plant: Plant, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    plant.data.joint("arm_short").qpos = math.nan
    plant.step((0, 0, 0), drivers_on=True)
    assert plant.home_assembly_left()
    assert "Nan" in caplog.text
    assert list(tmp_path.iterdir()) == []
    plant.reassemble()
    hold_set_points(plant, HOME, 0.1)
    assert plant.arms() == pytest.approx(HOME, abs=1e-5)


def let_sleep(plant: Plant, arms: Arms) -> None:
    """Hold set points until the plant sleeps, for 30 s at most."""
    pulses = GEAR.to_steps(arms)
    for _ in range(round(30 / STEP)):
        if plant.asleep:
            return
        plant.step(pulses, drivers_on=True)
    raise AssertionError(f"awake after 30 s; fastest joint: {abs(plant.data.qvel).max()} rad/s")


def at_rest(plant: Plant) -> list[float]:
    """Return the state without the time, which passes while a plant sleeps."""
    data = plant.data
    return [*data.qpos, *data.qvel, *data.qacc_warmstart, *plant.drive.set_points, *plant.drive.slipped]


def test_a_motion_after_a_sleep_is_bit_equal_to_one_without(plant: Plant) -> None:
    go(plant, HOME, TILTED)
    assert not plant.asleep
    let_sleep(plant, TILTED)
    other = plant.copy()
    before, began_s = at_rest(plant), plant.data.time
    plant.step(GEAR.to_steps(TILTED), drivers_on=True, count=50_000)
    assert at_rest(plant) == before
    assert plant.data.time - began_s == pytest.approx(100)
    for arms in ramp(TILTED, HOME):
        plant.step(GEAR.to_steps(arms), drivers_on=True)
        other.step(GEAR.to_steps(arms), drivers_on=True)
        assert at_rest(plant) == at_rest(other)


def test_a_force_a_step_and_the_motor_switch_wake_the_plant(plant: Plant) -> None:
    let_sleep(plant, HOME)
    plant.data.body("head").xfrc_applied[5] = 0.5
    hold_set_points(plant, HOME, 0.01)
    plant.data.body("head").xfrc_applied[5] = 0.0
    pushed = plant.arms()
    assert max(map(abs, pushed)) > 1e-5
    hold_set_points(plant, HOME, 0.5)
    assert max(map(abs, plant.arms())) < max(map(abs, pushed)) / 2, "the neck springs back"
    let_sleep(plant, HOME)
    plant.step((1, 1, 1), drivers_on=True)
    assert not plant.asleep
    let_sleep(plant, GEAR.to_rad((1, 1, 1)))
    plant.step((1, 1, 1), drivers_on=False)
    assert not plant.asleep


# -- test_stepper_drive ----------------------------------------------------------------------------


CYCLE = math.radians(4 * 1.8 * 26 / 68)
"""Four full steps of 1.8 deg at the motor, as an angle of the arm."""

counts = st.tuples(*[st.integers(-(2**31), 2**31 - 1)] * 3)
angles = st.tuples(*[st.floats(-20.0, 20.0)] * 3)


@given(counts, angles)
def test_set_points_differ_from_the_arm_by_at_most_half_a_cycle(
    pulses: tuple[int, int, int], arms: tuple[float, float, float]
) -> None:
    drive = StepperDrive()
    drive.step((0, 0, 0), HOME, on=True)
    drive.step(pulses, arms, on=True)
    assert all(
        abs(arm - set_point) <= CYCLE / 2 + 1e-7
        for arm, set_point in zip(arms, drive.set_points, strict=True)
    )
    assert all(steps % 4 == 0 for steps in drive.slipped)
