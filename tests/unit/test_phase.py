"""The phase of the publications: in the middle between two samples, whatever the first phase and the drift."""

from __future__ import annotations

import pytest

from beatrix_zenoh.node.state import PERIOD_S, phase_shift


def offsets(sampling_s: float, begin_s: float, drift: float) -> list[float]:
    """Return how far (s) 500 publications are from the last sample; `drift` of the board's clock, s per s."""
    due_s, found = begin_s, []
    for _ in range(500):
        board_s = due_s * (1 + drift)
        sample_s = board_s // sampling_s * sampling_s / (1 + drift)
        found.append(due_s - sample_s)
        due_s += PERIOD_S + phase_shift(due_s, sample_s, sampling_s)
    return found


@pytest.mark.parametrize("sampling_s", [0.002, 0.010])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.7, 0.999])
@pytest.mark.parametrize("drift", [0.0, 0.001, -0.001])
def test_publications_keep_away_from_the_times_of_samples(
    sampling_s: float, phase: float, drift: float
) -> None:
    last = offsets(sampling_s, 100 + phase * sampling_s, drift)[50:]
    assert sampling_s / 4 < min(last)
    assert max(last) < sampling_s * 3 / 4
