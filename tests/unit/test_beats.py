"""The beat of synthetic music: clicks in noise, at any tempo, phase, rate and loudness."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh import beats


def clicks(bpm: float, first_s: float, rate: int, noise: float, loud: float, seconds: float) -> np.ndarray:
    """Return 16-bit samples with a click on each beat, and noise, whose strength is a part of that of clicks."""
    random = np.random.default_rng(round(bpm * 1000))
    sound = random.normal(0, noise, round(seconds * rate))
    click = random.normal(0, 1, round(0.02 * rate)) * np.exp(-np.arange(round(0.02 * rate)) / (0.006 * rate))
    for at_s in np.arange(first_s, seconds - 0.05, 60 / bpm):
        sound[round(at_s * rate) :][: len(click)] += click
    samples: np.ndarray = (loud * sound / np.abs(sound).max()).astype(np.int16)
    return samples


@settings(max_examples=20, deadline=None)
@given(
    st.floats(60, 180),
    st.floats(0, 1.5),
    st.sampled_from([22_050, 44_100, 48_000]),
    st.floats(1e-4, 0.02),
    st.sampled_from([500.0, 30_000.0]),
    st.floats(7, 15),
)
def test_tempo_and_beats_are_found(
    bpm: float, first_s: float, rate: int, noise: float, loud: float, seconds: float
) -> None:
    found = beats.find(clicks(bpm, first_s, rate, noise, loud, seconds), rate)
    assert found is not None
    assert 60 / found.period_s == pytest.approx(bpm, rel=0.02)
    count = int((seconds - first_s) * bpm / 60)
    wrong = [found.first_s + n * found.period_s - first_s - n * 60 / bpm for n in range(count)]
    assert max(map(abs, wrong)) < 0.04


@pytest.mark.parametrize(
    "sound",
    [
        np.random.default_rng(1).normal(0, 3000, 10 * 44_100).astype(np.int16),
        np.zeros(10 * 44_100, np.int16),
        clicks(120, 0, 44_100, 0.01, 9000, 2.0),
    ],
    ids=["noise", "silence", "short"],
)
def test_what_has_no_beat_has_none(sound: np.ndarray) -> None:
    assert beats.find(sound, 44_100) is None
