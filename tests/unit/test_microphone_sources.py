"""Sound without microphones: the test tone, WAV files, and the values of --microphones."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
import pytest

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.node.microphones import BEHIND, BLOCK, BLOCK_NS, RATE, BlockClock
from hw_node.microphones.microphones import SoundSource, choose
from hw_node.microphones.stand_ins import SoundFile, Tone


def written(path: Path, samples: list[list[int]], *, rate: int = RATE, width: int = 2) -> Path:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(len(samples[0]))
        file.setsampwidth(width)
        file.setframerate(rate)
        file.writeframes(np.array(samples, "<i2").tobytes())
    return path


def taken(
    source: SoundSource, count: int
) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.int16]], list[int]]:
    """Return the frames of `count` blocks in one array, and the times of the blocks (ns)."""
    source.open()
    blocks = [block for block in (source.next(1.0) for _ in range(count)) if block is not None]
    source.close()
    data = b"".join(block.samples for block in blocks)
    return np.frombuffer(data, "<i2").reshape(-1, 2), [block.t_mono_ns for block in blocks]


def test_the_tone_has_another_frequency_in_each_ear_and_no_click_between_blocks() -> None:
    frames, times_ns = taken(Tone(), 5)
    assert np.diff(times_ns).tolist() == [BLOCK_NS] * 4
    spectrum = np.abs(np.fft.rfft(frames, axis=0))
    peaks = spectrum.argmax(axis=0) * RATE / len(frames)
    assert peaks.tolist() == [500.0, 1000.0]
    assert (np.sort(spectrum, axis=0)[-2] < spectrum.max(axis=0) / 1000).all()


@pytest.mark.parametrize("channels", [1, 2])
def test_a_file_is_repeated_without_a_gap(tmp_path: Path, channels: int) -> None:
    ramp = [[i + 10_000 * channel for channel in range(channels)] for i in range(BLOCK + 100)]
    frames, _ = taken(SoundFile(written(tmp_path / "x.wav", ramp)), 3)
    wanted = np.resize(np.arange(BLOCK + 100), 3 * BLOCK)
    assert (frames[:, 0] == wanted).all()
    assert (frames[:, 1] == wanted + (10_000 if channels == 2 else 0)).all()


@pytest.mark.parametrize(("rate", "width"), [(44_100, 2), (RATE, 4), (RATE, 1)])
def test_a_file_in_another_format_is_refused_with_the_right_one(
    tmp_path: Path, rate: int, width: int
) -> None:
    source = SoundFile(written(tmp_path / "x.wav", [[1, 2], [3, 4]], rate=rate, width=width))
    with pytest.raises(
        NoAnswer, match=rf"of {8 * width} bits at {rate} Hz\. Give a WAV file of 16 bits at 48000 Hz"
    ):
        source.open()


@pytest.mark.parametrize("content", [b"", b"RIFF", b"no sound at all"])
def test_a_file_that_is_not_wav_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.wav"
    path.write_bytes(content)
    with pytest.raises(NoAnswer, match="cannot be played"):
        SoundFile(path).open()


def test_after_a_delay_old_blocks_are_dropped_and_counted() -> None:
    clock = BlockClock()
    clock.restart()
    first = clock.wait(1.0)
    assert first is not None
    clock._next_ns -= 50 * BLOCK_NS  # as if the process had been suspended for a second
    next_one = clock.wait(1.0)
    assert next_one is not None
    assert clock.dropped >= 49 * BLOCK
    assert next_one >= first
    clock._next_ns -= (BEHIND - 1) * BLOCK_NS
    before = clock.dropped
    assert clock.wait(1.0) is not None
    assert clock.dropped == before, "a short delay loses nothing"


def test_a_block_that_is_not_complete_is_waited_for_only_as_long_as_asked() -> None:
    clock = BlockClock()
    clock.restart()
    assert clock.wait(0.001) is None


@pytest.mark.parametrize("word", ["", "off"])
def test_microphones_are_off_by_default(word: str) -> None:
    assert choose(word) is None


@pytest.mark.parametrize(
    ("word", "teaches"),
    [
        ("file:/no/such.wav", "does not exist"),
        ("file:", "does not exist|Name a WAV"),
    ],
)
def test_a_wrong_value_names_the_allowed_ones(word: str, teaches: str) -> None:
    with pytest.raises(WrongUsage, match=teaches):
        choose(word)
