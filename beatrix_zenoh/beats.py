"""The beat of music with a steady tempo: how fast, and when the first beat is.

Onsets are where the spectrum grows (spectral flux; Bello et al. 2005). Autocorrelation finds the period, and the Fourier
component of the onsets near it the exact period and the phase (Grosche and Müller 2011).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

SLOWEST, FASTEST = 60.0, 180.0
"""Tempos that are found (beats a minute)."""
HZ: Final = 100
"""Frames of the spectrum a second."""
SHORTEST_S, LONGEST_S = 3.0, 120.0
"""Least duration of samples, and how much of their beginning is analysed."""
ENOUGH: Final = 20_000
"""Rate (1/s) that is enough to hear beats; aliasing does no harm."""
CLEAR: Final = 0.25
"""Least autocorrelation of a beat; noise has less."""
ALIKE: Final = 0.75
"""A faster tempo is the beat if its autocorrelation is this part of the best one: each second beat fits as well."""
LOUD: Final = 0.3
"""The first beat has this part of the strongest onset."""
CHUNK: Final = 1 << 12
"""Frames whose spectra are in memory at once."""

Floats = npt.NDArray[np.float64]


class Beats(NamedTuple):
    """Beats at equal distances."""

    first_s: float
    """from the beginning of the samples"""
    period_s: float


def find(samples: npt.NDArray[np.generic], rate: float) -> Beats | None:
    """Return the beats of samples, shape (n,), with this rate (1/s); None if no steady beat is heard."""
    fewer = max(1, rate // ENOUGH)
    samples, rate = samples[: round(LONGEST_S * rate) : fewer], rate / fewer
    if len(samples) < SHORTEST_S * rate:
        return None
    flux, centre_s = _onsets(samples, rate)
    centred = flux - flux.mean()
    power = float(centred @ centred) / len(centred)
    longest = min(round(HZ * 60 / SLOWEST) + 1, len(flux) // 2)
    lags = np.arange(math.floor(HZ * 60 / FASTEST), longest + 1)
    alike = np.array([centred[lag:] @ centred[:-lag] / (len(centred) - lag) for lag in lags])
    alike = np.convolve(alike, (0.5, 1.0, 0.5), "same")  # a period between two frames
    if not power or alike.max() < CLEAR * power:
        return None
    peaks = np.flatnonzero(alike >= ALIKE * alike.max())
    fastest = peaks[peaks <= peaks[0] + 3]
    period, phase = _exact(centred, float(lags[fastest[np.argmax(alike[fastest])]]))
    begin = int(np.argmax(flux >= LOUD * flux.max())) - 0.25 * period
    first = phase + period * math.ceil((begin - phase) / period)
    return Beats(max(0.0, first / HZ + centre_s), period / HZ)


def _onsets(samples: npt.NDArray[np.generic], rate: float) -> tuple[Floats, float]:
    """Return how much the spectrum grows at HZ frames a second, and the time (s) of the first frame's onset."""
    size = 1 << round(math.log2(rate / 25))
    samples = np.pad(samples, (size, 0))  # else an onset at the very beginning would not be seen
    starts = (np.arange(int((len(samples) - size) / rate * HZ)) * rate / HZ).astype(np.int64)
    window, last = np.hanning(size), np.zeros(size // 2 + 1)
    flux: list[Floats] = []
    for at in range(0, len(starts), CHUNK):
        frames = samples[starts[at : at + CHUNK, None] + np.arange(size)] * window
        loud = np.log1p(np.abs(np.fft.rfft(frames)) / size * 100 / _scale(samples))
        grown = np.diff(loud, axis=0, prepend=last[None] if at else loud[:1])
        flux.append(np.maximum(grown, 0.0).sum(axis=1))
        last = loud[-1]
    return np.concatenate(
        flux
    ), -0.3 * size / rate  # an onset is heard before it reaches the middle of the window


def _scale(samples: npt.NDArray[np.generic]) -> float:
    """Return the loudest sample, so that loud and quiet files have the same onsets."""
    return float(max(abs(int(samples.max())), abs(int(samples.min())))) or 1.0


def _exact(centred: Floats, about: float) -> tuple[float, float]:
    """Return period and phase (frames) of the strongest Fourier component within 2.5 % of a period."""
    at, width = np.arange(len(centred)), min(0.025, about / len(centred) * 4)
    count = max(9, math.ceil(width * len(centred) / about * 16)) | 1
    periods = about * np.linspace(1 - width, 1 + width, count)
    found = np.array([centred @ np.exp(2j * math.pi * at / period) for period in periods])
    best = int(np.argmax(np.abs(found)))
    return float(periods[best]), float(np.angle(found[best]) / (2 * math.pi) % 1.0 * periods[best])
