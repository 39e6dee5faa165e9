"""Points of a recorded motion: enough for a replay, and two points per rest."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.client.degrees import ArmAngles
from beatrix_zenoh.recording.record_motion import Timed, thinned

TURNS = st.lists(
    st.tuples(st.floats(-30, 30), st.integers(1, 60), st.integers(0, 60)), min_size=1, max_size=4
)


def published(turns: list[tuple[float, int, int]]) -> list[Timed]:
    """Return 50 points per second of an arm; each turn has an angle (deg) and numbers of moving and resting points."""
    angles = [0.0]
    for by, moving, resting in turns:
        angles += [angles[-1] + by * (k + 1) / moving for k in range(moving)]
        angles += [angles[-1]] * resting
    return [(k * 0.02, ArmAngles(angle, 0.0, 0.0)) for k, angle in enumerate(angles)]


@given(TURNS, st.sampled_from([0.02, 0.04, 0.05, 0.1]))
@settings(deadline=None)
def test_omitted_points_lie_between_kept_points(turns: list[tuple[float, int, int]], period_s: float) -> None:
    points = published(turns)
    kept = thinned(points, period_s)
    assert kept[0] == points[0]
    assert kept[-1] == points[-1]
    t = np.array([point[0] for point in kept])
    assert (np.diff(t) > 0).all()
    between = np.interp([point[0] for point in points], t, [point[1][0] for point in kept])
    steps = np.abs(np.diff([point[1][0] for point in points], prepend=0.0))
    most = max(steps) * (period_s / 0.02 + 1) + 0.01
    assert between == pytest.approx([point[1][0] for point in points], abs=most)


def test_rests_at_start_and_end_are_shortened() -> None:
    whole = published([(0.0, 100, 0), (20.0, 10, 0), (0.0, 200, 0)])
    assert thinned(whole, 0.04)[-1][0] == pytest.approx(6.2), "the whole rests"
    kept = thinned(whole, 0.04, 0.5)
    assert kept[-1][0] == pytest.approx(0.5 + 0.2 + 0.5, abs=0.05)
    assert [place for _, place in kept] == [place for _, place in thinned(whole, 0.04)]
