"""The phase of the publications: in the middle between two samples, or just after a turn of a virtual board."""

from __future__ import annotations

import pytest

from beatrix_zenoh.node.state import PERIOD_S, phase_shift, turn_shift
from beatrix_zenoh.schedule import SLACK_S


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


@pytest.mark.parametrize("phase", [0.0, 0.0005, 0.003, 0.0099, 0.0101, 0.0195])
def test_publications_get_into_the_pass_of_the_turns(phase: float) -> None:
    due_s, after = 100 + phase, []
    for _ in range(200):
        after.append(due_s % PERIOD_S)
        due_s += PERIOD_S + turn_shift(due_s, due_s // PERIOD_S * PERIOD_S)
    assert min(after[60:]) > 0
    assert max(after[60:]) < SLACK_S
