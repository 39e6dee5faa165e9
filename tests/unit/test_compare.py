"""Lag and differences of two recordings, from movements whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh._generated.messages import Head, Positions, Steps, Vector3
from beatrix_zenoh.compare import AXES, Floats, Recording, compare, lag, recording, resample, resting
from beatrix_zenoh.trajectory import plan

HZ = 50
ANGLES = st.floats(-60, 60).filter(lambda angle: abs(angle) > 5)
TARGETS = st.lists(st.tuples(ANGLES, ANGLES, ANGLES), min_size=2, max_size=4)
LAGS = st.floats(-0.2, 0.2)


def movement(targets: list[tuple[float, float, float]], t: Floats) -> Floats:
    """Angles (n, 6) in deg of a head that turns to one target after the other, resting between, from t = 1 s."""
    here, begin = (0.0, 0.0, 0.0), 1.0
    arms = np.zeros((len(t), 3))
    for target in targets:
        way = plan(here, (0.0, 0.0, 0.0), target, (60.0, 60.0, 60.0), 180.0, straight=True)
        late = t >= begin
        arms[late] = [way.at(moment - begin)[0] for moment in t[late]]
        here, begin = target, begin + way.duration + 0.4
    return np.hstack([arms, arms])


def recorded(
    targets: list[tuple[float, float, float]], lag_s: float, phase_s: float, noise: float = 0.0, seed: int = 0
) -> Recording:
    """What a robot that is late by `lag_s` publishes, 50 times a second from a phase of its own."""
    t = np.arange(0.0, 12.0, 1 / HZ) + phase_s
    jitter = np.random.default_rng(seed).normal(0.0, noise, (len(t), 6))
    return Recording(t, movement(targets, t - lag_s) + jitter)


@given(TARGETS, LAGS, st.floats(0, 1 / HZ), st.integers(0, 2**16))
def test_known_lag_is_recovered_within_two_milliseconds(
    targets: list[tuple[float, float, float]], lag_s: float, phase_s: float, seed: int
) -> None:
    first = recorded(targets, 0.0, 0.0)
    second = recorded(targets, lag_s, phase_s, noise=0.02, seed=seed)
    assert lag(first, second) == pytest.approx(lag_s, abs=0.002)


@given(TARGETS, LAGS)
def test_lag_has_the_opposite_sign_the_other_way_round(
    targets: list[tuple[float, float, float]], lag_s: float
) -> None:
    first, second = recorded(targets, 0.0, 0.0), recorded(targets, lag_s, 0.007)
    assert lag(first, second) == pytest.approx(-lag(second, first), abs=0.002)


@given(TARGETS, st.floats(-3, 3))
def test_an_arm_that_stands_apart_is_apart_by_that_everywhere(
    targets: list[tuple[float, float, float]], offset: float
) -> None:
    first = recorded(targets, 0.0, 0.0)
    apart = Recording(first.t, first.angles + np.array([0, offset, 0, 0, 0, 0]))
    found = {axis.axis: axis for axis in compare(first, apart).axes}
    middle = found["middle"]
    assert (middle.largest, middle.rms, middle.at_rest) == pytest.approx((abs(offset),) * 3, abs=1e-6)
    assert found["short"].largest == pytest.approx(0, abs=1e-9)


def test_a_late_robot_is_apart_while_moving_and_not_at_rest() -> None:
    targets = [(30.0, 30.0, 30.0), (-30.0, -30.0, -30.0)]
    found = compare(recorded(targets, 0.0, 0.0), recorded(targets, 0.02, 0.003))
    assert found.axes[0].largest == pytest.approx(60 * 0.02, abs=0.05)
    assert found.arms_at_rest < 0.4
    assert found.lag_s == pytest.approx(0.02, abs=0.002)


def test_without_movement_there_is_no_lag() -> None:
    still = Recording(np.arange(0.0, 5.0, 0.02), np.zeros((250, 6)))
    assert math.isnan(compare(still, still).lag_s)


def test_without_rest_there_is_no_difference_at_rest() -> None:
    t = np.arange(0.0, 5.0, 0.02)
    turning = Recording(t, np.tile(20 * t[:, None], (1, 6)))
    assert math.isnan(compare(turning, turning).arms_at_rest)


def test_yaw_beyond_half_a_turn_is_compared_on_the_circle() -> None:
    t = np.arange(0.0, 2.0, 0.02)
    first = Recording(t, np.full((100, 6), 179.5))
    second = Recording(t, np.full((100, 6), -179.5))
    assert compare(first, second).axes[3].largest == pytest.approx(1.0)


def test_recordings_that_hardly_overlap_are_refused() -> None:
    t = np.arange(0.0, 2.0, 0.02)
    with pytest.raises(ValueError, match="share"):
        compare(Recording(t, np.zeros((100, 6))), Recording(t + 1.5, np.zeros((100, 6))))


def test_empty_recording_is_refused() -> None:
    with pytest.raises(ValueError, match="fewer than two"):
        compare(recording([]), recording([]))


def test_resampling_keeps_what_was_recorded() -> None:
    first = recorded([(10.0, 20.0, 30.0), (5.0, 6.0, 7.0)], 0.0, 0.0)
    assert resample(first, first.t) == pytest.approx(first.angles)


def test_rest_is_where_nothing_turns_for_a_while() -> None:
    t = np.arange(0.0, 4.0, 0.01)
    moving = (t > 1) & (t < 3)
    angles = np.repeat(np.clip(t - 1, 0, 2)[:, None] * 20, 6, axis=1)
    rest = resting(angles)
    assert not rest[moving].any()
    assert rest[(t < 0.85) | (t > 3.15)].all()


def test_recording_turns_messages_into_degrees_in_the_order_of_the_axes() -> None:
    def message(k: int) -> Positions:
        arms = Vector3(*(math.radians(angle) for angle in (1, 2, 3)))
        head = Head(*(math.radians(angle) for angle in (4, 5, 6)))
        return Positions(
            seq=k,
            t_mono_ns=k * 20_000_000,
            t_wall_ns=0,
            position=arms,
            velocity=arms,
            commanded=arms,
            steps=Steps(0, 0, 0),
            head=head,
        )

    found = recording([message(0), message(1)])
    assert list(found.t) == pytest.approx([0, 0.02])
    assert dict(zip(AXES, found.angles[1], strict=True)) == pytest.approx(
        {"short": 1, "middle": 2, "long": 3, "yaw": 4, "pitch": 5, "roll": 6}
    )
