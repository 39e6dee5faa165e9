"""WAV files: those of 16 bits are played, each other one is refused with the reason."""

from __future__ import annotations

import io
import wave
from pathlib import Path

import numpy as np
import pytest

from beatrix_zenoh import wav
from beatrix_zenoh.client.sound import mono
from beatrix_zenoh.contract.errors import WrongUsage

RATE = 48_000


def file_of(data: bytes, bits: int = 16) -> bytes:
    """Return a WAV file of two channels."""
    content = io.BytesIO()
    with wave.open(content, "wb") as file:
        file.setparams((2, bits // 8, RATE, 0, "NONE", ""))
        file.writeframes(data)
    return content.getvalue()


def test_a_file_of_16_bits_is_read_and_mixed(tmp_path: Path) -> None:
    frames = np.array([[-(2**15), 2**15 - 1], [0, -1], [100, 300]], "<i2")
    path = tmp_path / "x.wav"
    path.write_bytes(file_of(frames.tobytes()))
    found = wav.read(path)
    assert (found.rate, found.samples.tolist()) == (RATE, frames.tolist())
    assert mono(path) == np.rint(frames.mean(axis=1)).astype("<i2").tobytes()


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (file_of(bytes(12), 24), "it has 24 bits at 48000 Hz"),
        (file_of(b""), "it contains no sound"),
        (b"OggS" + bytes(100), "it is damaged or has another format"),
        (file_of(bytes(8))[:30], "it is damaged or has another format"),
        (file_of(bytes(4 * RATE * 11)), r"it lasts 11.0 s\. .* at most 10 s long"),
    ],
)
def test_every_other_file_is_refused(tmp_path: Path, content: bytes, why: str) -> None:
    path = tmp_path / "x.wav"
    path.write_bytes(content)
    with pytest.raises(WrongUsage, match=f"cannot be played: {why}"):
        mono(path)
