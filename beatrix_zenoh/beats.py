"""The beat of music with a steady tempo: how fast, and when the first beat is.

Onsets are where the spectrum grows (spectral flux; Bello et al. 2005). Autocorrelation finds the period, and the
Fourier components near it the exact period and the phase (Grosche and Müller 2011).
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
LOUD: Final = 0.5
"""The first beat has this part of the strongest onset."""
BANDS, LOWEST_HZ = 16, 40.0
"""Frequency bands in which onsets are sought."""
HARMONICS: Final = np.arange(1, 5)
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
    window, last = np.hanning(size), np.zeros(BANDS)
    scale = (
        float(np.abs(samples.astype(np.float64)).max()) or 1.0
    )  # loud and quiet files have the same onsets
    edges = np.geomspace(LOWEST_HZ, 0.45 * rate, BANDS + 1)
    hz = np.fft.rfftfreq(size, 1 / rate)[:, None]
    bands = ((hz >= edges[:-1]) & (hz < edges[1:])).astype(np.float64)  # a drum counts as much as a cymbal
    flux: list[Floats] = []
    for at in range(0, len(starts), CHUNK):
        frames = samples[starts[at : at + CHUNK, None] + np.arange(size)] * window
        loud = np.log1p(np.abs(np.fft.rfft(frames)) @ bands / size * 100 / scale)
        grown = np.diff(loud, axis=0, prepend=last[None] if at else loud[:1])
        flux.append(np.maximum(grown, 0.0).sum(axis=1))
        last = loud[-1]
    return np.concatenate(
        flux
    ), -0.3 * size / rate  # an onset is heard before it reaches the middle of the window


def _exact(centred: Floats, about: float) -> tuple[float, float]:
    """Return period and phase (frames) of the pulses that fit best, near a period.

    Several harmonics make the pulses short, so that weak off-beats do not move the phase.
    """
    at, width = np.arange(len(centred)), 1.2 / about
    count = math.ceil(2 * width * 16 * len(centred) / about) + 8
    periods = about * np.linspace(1 - width, 1 + width, count)
    turns = np.exp(2j * math.pi * at / periods[:, None])
    found = np.stack([turns**harmonic @ centred for harmonic in HARMONICS])
    phases = np.arange(128) / 128
    fits = np.real(found.T @ np.exp(-2j * math.pi * np.outer(HARMONICS, phases)))
    best, phase = np.unravel_index(int(np.argmax(fits)), fits.shape)
    return float(periods[best]), float(phases[phase] * periods[best])
