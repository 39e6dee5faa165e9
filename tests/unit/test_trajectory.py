"""Trajectories: durations in closed form, straight lines, smooth new targets."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.motion.gear import Arms
from beatrix_zenoh.motion.trajectory import Trajectory, plan

ACCELERATION = 3.0
REST: Arms = (0.0, 0.0, 0.0)

angles = st.tuples(*[st.floats(-3, 3)] * 3)
rates = st.tuples(*[st.floats(-2, 2)] * 3)
speeds = st.tuples(*[st.floats(0.05, 2)] * 3)


def samples(trajectory: Trajectory, count: int) -> list[tuple[float, Arms, Arms]]:
    """Return times, angles and velocities along the trajectory, also at the start of each section."""
    times = {trajectory.duration * i / count for i in range(count + 1)}
    times |= {section.begin for section in trajectory.sections}
    return [(t, *trajectory.at(t)) for t in sorted(times)]


@pytest.mark.parametrize(
    ("way", "speed", "expected"),
    [
        (2.0, 1.0, 2.0 / 1.0 + 1.0 / ACCELERATION),
        (0.1, 1.0, 2 * math.sqrt(0.1 / ACCELERATION)),
        (-2.0, 1.0, 2.0 / 1.0 + 1.0 / ACCELERATION),
        (1 / ACCELERATION, 1.0, 2.0 / ACCELERATION),
        (0.0, 1.0, 0.0),
    ],
)
def test_the_duration_from_rest_equals_the_closed_form(way: float, speed: float, expected: float) -> None:
    trajectory = plan(REST, REST, (way, 0.0, 0.0), (speed, 1.0, 1.0), ACCELERATION, straight=False)
    assert trajectory.duration == pytest.approx(expected)


def test_an_arm_that_cannot_stop_in_time_turns_back() -> None:
    trajectory = plan(REST, (1.5, 0.0, 0.0), (0.1, 0.0, 0.0), (1.5, 1.0, 1.0), ACCELERATION, straight=False)
    overshoot = 1.5**2 / (2 * ACCELERATION)
    assert max(arms[0] for _, arms, _ in samples(trajectory, 400)) == pytest.approx(overshoot, abs=1e-4)
    assert trajectory.duration == pytest.approx(
        1.5 / ACCELERATION + 2 * math.sqrt((overshoot - 0.1) / ACCELERATION)
    )


@given(angles, angles, speeds)
def test_a_straight_motion_from_rest_stays_on_its_line(start: Arms, target: Arms, speed: Arms) -> None:
    trajectory = plan(start, REST, target, speed, ACCELERATION, straight=True)
    ways = [b - a for a, b in zip(start, target, strict=True)]
    longest = max(range(3), key=lambda i: abs(ways[i]))
    for _, arms, velocity in samples(trajectory, 20):
        done = (arms[longest] - start[longest]) / ways[longest] if ways[longest] else 0.0
        for i in range(3):
            assert arms[i] == pytest.approx(start[i] + done * ways[i], abs=1e-9)
            assert abs(velocity[i]) <= speed[0] + 1e-9


@given(angles, rates, angles, speeds, st.booleans())
@example(REST, REST, (0.0, 0.0, 1e-20), (1.0, 1.0, 1.0), False)
def test_a_motion_to_any_new_target_is_smooth_not_too_fast_and_arrives(
    start: Arms, velocity: Arms, target: Arms, speed: Arms, straight: bool
) -> None:
    trajectory = plan(start, velocity, target, speed, ACCELERATION, straight=straight)
    assert trajectory.at(trajectory.duration) == (target, REST)
    if trajectory.sections:
        begin, rate = trajectory.at(0.0)
        assert begin == pytest.approx(start, abs=1e-7)
        assert rate == pytest.approx(velocity, abs=1e-7)
    previous, tops = None, [speed[0]] * 3 if straight else speed
    for t, arms, rate in samples(trajectory, 50):
        assert all(abs(rate[i]) <= max(tops[i], abs(velocity[i])) + 1e-9 for i in range(3))
        if previous is not None:
            before, arms_before, rate_before = previous
            span = t - before
            for i in range(3):
                assert abs(rate[i] - rate_before[i]) <= ACCELERATION * span + 1e-6
                fastest = max(abs(rate[i]), abs(rate_before[i])) + ACCELERATION * span
                assert abs(arms[i] - arms_before[i]) <= fastest * span + 1e-7
        previous = (t, arms, rate)
