"""Sounds for the simulated room, all of them computed: a clap, a voice, and noise."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.node.sensors import RATE
from sim_node.shapes import Vector

LOUDNESS: Final = 0.05
"""Root mean square of voice and noise at a distance of 1 m."""
FADE: Final = 240
"""Frames (5 ms) over which a sound begins and ends, so that it does not click."""
SEED: Final = 1

Samples = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class PlayingSound:
    """A sound that is repeated until its end."""

    name: str
    began_s: float
    """time of its first sample, by the monotonic clock"""
    seconds: float
    samples: Samples = field(repr=False)

    def left_s(self, now_s: float) -> float:
        """Return how much longer it plays (s)."""
        return max(0.0, self.began_s + self.seconds - now_s)

    def emitted(self, first: int, count: int) -> Samples:
        """Return `count` samples from number `first` on; zeros before the sound begins and after its end."""
        total, begin = round(self.seconds * RATE), first % len(self.samples)
        if begin + count <= len(self.samples):
            samples = self.samples[begin : begin + count]
        else:
            samples = self.samples.take(np.arange(begin, begin + count), mode="wrap")
        if first >= FADE and first + count <= total - FADE:
            return samples
        numbers = np.arange(first, first + count)
        fade: Samples = np.clip(np.minimum(numbers + 1, total - numbers) / FADE, 0.0, 1.0).astype(np.float32)
        return samples * fade


def _noise(length: int, low_hz: float, high_hz: float, seed: int = SEED) -> Vector:
    """Return noise between two frequencies that can be repeated without a seam, root mean square 1."""
    random = np.random.default_rng(seed)
    hz = np.fft.rfftfreq(length, 1 / RATE)
    inside = (hz >= low_hz) & (hz <= high_hz)
    spectrum = inside * np.exp(1j * random.uniform(0, math.tau, len(hz)))
    samples: Vector = np.fft.irfft(spectrum, length)
    samples /= samples.std()
    return samples


def noise() -> Vector:
    """Return a second of noise from 100 Hz to 12 kHz."""
    return _noise(RATE, 100.0, 12_000.0)


def clap() -> Vector:
    """Return a clap, as short as that of two hands, and silence up to one second."""
    samples = _noise(RATE, 400.0, 12_000.0, SEED + 1)
    t_s = np.arange(RATE) / RATE - 0.01
    samples *= np.where(t_s < 0, 0.0, np.exp(-np.maximum(t_s, 0) / 0.008))
    samples *= 0.7 / LOUDNESS / np.abs(samples).max()
    return samples


VOWELS: Final = (
    (730.0, 1090.0, 2440.0),
    (530.0, 1840.0, 2480.0),
    (270.0, 2290.0, 3010.0),
    (570.0, 840.0, 2410.0),
)
"""Formants (Hz) of the vowels a, e, i, o, after Peterson and Barney, 1952."""
SYLLABLE_S: Final = 0.5
PITCH_HZ: Final = 120.0


def voice() -> Vector:
    """Return two seconds of a voice that says `sa se si so`."""
    length = round(SYLLABLE_S * RATE)
    hiss = _noise(length, 2000.0, 12_000.0, SEED + 2)
    t_s = np.arange(length) / RATE
    # A pitch that falls a little, as in speech, in whole periods, so that the syllables can be repeated.
    turns = PITCH_HZ * (t_s + 0.03 * np.sin(math.tau * t_s / SYLLABLE_S) / 3)
    opens = np.clip(np.minimum(t_s - 0.08, 0.42 - t_s) / 0.04, 0.0, 1.0)
    hisses = np.clip(np.minimum(t_s, 0.1 - t_s) / 0.02, 0.0, 1.0)
    breath = 0.2 * hisses * hiss + 0.06 * opens * hiss
    return np.concatenate([opens * _vowel(turns, formants) + breath for formants in VOWELS])


def _vowel(turns: Vector, formants: tuple[float, ...]) -> Vector:
    """Return the sum of the harmonics of a pitch, loud near the formants; `turns` are periods of the pitch."""
    samples: Vector = np.zeros(len(turns))
    for number in range(1, 34):
        hz = number * PITCH_HZ
        loud = sum(1 / (1 + ((hz - peak) / 90.0) ** 2) / rank for rank, peak in enumerate(formants, 1))
        samples += (loud + 0.02) * np.sin(math.tau * number * turns)
    samples /= samples.std()
    return samples


GENERATORS: Final[dict[str, Callable[[], Vector]]] = {"clap": clap, "voice": voice, "noise": noise}


@cache
def generated(name: str) -> Samples:
    """Return the samples of a sound; the first time takes some ms."""
    samples = GENERATORS[name]().astype(np.float32)
    loud = LOUDNESS if name == "clap" else LOUDNESS / float(samples.std())
    return loud * samples
