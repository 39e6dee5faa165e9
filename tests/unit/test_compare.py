"""Lag and differences of two recordings with known results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from golden import same
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs
from statuses import AT_HOME

from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.motion.trajectory import plan
from beatrix_zenoh.recording.compare import Thresholds, compare
from beatrix_zenoh.recording.series import (
    Recording,
    heads_apart,
    recording,
    regularity,
    unbroken,
)

HZ = 50


def shaken(lags_s: Sequence[float], offset: float = 0.0) -> Recording:
    """Return a recording of motions, one every two seconds, each with a lag (s); the middle arm has an offset (deg)."""
    t = np.arange(0.0, 2.0 * len(lags_s) + 2.0, 1 / HZ)
    angles = np.zeros((len(t), 6))
    for number, lag_s in enumerate(lags_s):
        turn = plan((0.0,) * 3, (0.0,) * 3, (20.0, 30.0, 10.0), (60.0,) * 3, 180.0, straight=True)
        begin = 2.0 * number + 1.0 + lag_s
        sign = 1 if number % 2 == 0 else -1
        rest = np.array([0.0, 0.0, 0.0]) if sign > 0 else np.array([20.0, 30.0, 10.0])
        later = t >= begin
        angles[later, :3] = [rest + sign * np.array(turn.at(moment - begin)[0]) for moment in t[later]]
    return Recording(t, angles + np.array([0, offset, 0, 0, 0, 0]))


def test_the_lag_is_that_of_the_set_points_if_they_were_recorded() -> None:
    first, second = shaken([0.0] * 3), shaken([0.05] * 3)
    soft = Recording(second.t, second.angles, commanded=shaken([0.03] * 3).angles[:, :3])
    found = compare(Recording(first.t, first.angles, commanded=first.angles[:, :3]), soft)
    assert found.lag_s == pytest.approx(0.03, abs=0.002)
    assert found.axes[0].lag_s == pytest.approx(0.05, abs=0.002)
    assert math.isnan(compare(first, second).off_set_points[0])


@given(st.integers(0, 2**16))
def test_the_compared_part_has_no_holes(seed: int) -> None:
    random = np.random.default_rng(seed)
    both = []
    for _ in range(2):
        t = np.cumsum(random.choice([0.02, 0.02, 0.5, 3.0], 60))
        both.append(Recording(t, np.zeros((60, 6))))
    first, second = unbroken(both[0], both[1])
    if first is not both[0]:
        assert np.max(np.diff(first.t), initial=0.0) <= 1.0 + 1e-9
        assert np.max(np.diff(second.t), initial=0.0) <= 1.0 + 1e-9


ALLOWED = Thresholds(lag_s=0.01, rms_deg=0.2, largest_deg=0.5, rest_deg=0.2, missed_steps=0)


def test_each_exceeded_threshold_is_reported() -> None:
    found = compare(replace(shaken([0.0] * 3), slipped=-4), shaken([-0.2] * 3, offset=1.0))
    same("compare.exceeded thresholds", "\n".join(ALLOWED.exceeded(found)))
    (sentence,) = Thresholds(lag_s=0.05).exceeded(compare(shaken([0.0] * 3), shaken([0.05004] * 3)))
    assert "The lag is +0.05004" in sentence, "it never looks equal to the threshold"


def test_thresholds_that_cannot_be_checked_are_reported() -> None:
    still = Recording(np.arange(0.0, 5.0, 0.02), np.zeros((250, 6)))
    same("compare.unknown thresholds", "\n".join(ALLOWED.exceeded(compare(still, still))))


@pytest.mark.parametrize("unknown", [0, -1])
def test_a_threshold_fails_if_one_axis_is_unknown(unknown: int) -> None:
    found = compare(shaken([0.0] * 3), shaken([0.0] * 3))
    assert Thresholds(rest_deg=1.0).exceeded(found) == []
    axes = list(found.axes)
    axes[unknown] = replace(axes[unknown], at_rest=math.nan)
    assert len(Thresholds(rest_deg=1.0).exceeded(replace(found, axes=tuple(axes)))) == 1


@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_a_threshold_that_is_negative_or_not_finite_is_refused(value: float) -> None:
    with pytest.raises(WrongUsage, match="give a number, 0 or more"):
        Thresholds(rms_deg=value)


def test_yaw_is_compared_modulo_a_turn() -> None:
    t = np.arange(0.0, 2.0, 0.02)
    first = Recording(t, np.full((100, 6), 179.5))
    second = Recording(t, np.full((100, 6), -179.5))
    assert compare(first, second).axes[3].largest == pytest.approx(1.0)


@given(st.lists(st.tuples(*[st.floats(-80, 80)] * 3), min_size=2, max_size=2))
def test_the_angle_between_heads_is_that_of_their_rotations(heads: list[tuple[float, float, float]]) -> None:
    one, other = (np.array(rotation_of(*(math.radians(angle) for angle in head))) for head in heads)
    trace = float(np.clip((np.trace(one @ other.T) - 1) / 2, -1, 1))
    (found,) = heads_apart(np.array(heads[:1]), np.array(heads[1:]))
    assert math.cos(math.radians(found)) == pytest.approx(trace, abs=1e-9)


def test_gaps_and_lost_samples_are_counted() -> None:
    kept = [k for k in range(100) if k not in (40, 41, 70)]
    found = regularity(
        recording(
            [structs.replace(AT_HOME, seq=k, t_mono_ns=k * 20_000_000) for k in [*kept[:50], *kept[49:]]]
        )
    )
    assert (found.samples, found.lost, found.gaps) == (97, 3, 2)
    assert found.period_ms == pytest.approx(20)
    assert found.longest_ms == pytest.approx(60)
