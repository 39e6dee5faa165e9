"""WAV files of 16 bits, as most programs write them."""

from __future__ import annotations

import wave
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

READABLE: Final = "16 bits (in Audacity: `Signed 16-bit PCM`)"


class Wav(NamedTuple):
    """The sound of a WAV file."""

    samples: npt.NDArray[np.int16]
    """(frames, channels)"""
    rate: int
    """frames per second"""


def read(path: Path, longest_s: float = float("inf")) -> Wav:
    """Read a WAV file of at most `longest_s` (s).

    Raises:
        OSError: the file cannot be read.
        ValueError: it has another format; the message completes a sentence about the file.
    """
    try:
        with wave.open(str(path), "rb") as file:
            channels, width, rate, frames = file.getparams()[:4]
            if width != 2 or not rate:
                raise ValueError(f"it has {8 * width} bits at {rate} Hz")
            if frames > longest_s * rate:
                raise ValueError(f"it lasts {frames / rate:.1f} s")
            samples = np.frombuffer(file.readframes(frames), "<i2")
    except (wave.Error, EOFError, RuntimeError) as error:
        raise ValueError("it is damaged or has another format") from error
    if len(samples) < channels:
        raise ValueError("it contains no sound")
    return Wav(samples[: len(samples) // channels * channels].reshape(-1, channels), rate)
