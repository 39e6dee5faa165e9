"""Sound without microphones: the test tone, WAV files, and the values of --microphones."""

from __future__ import annotations

import re
import wave
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.node.sensors import BLOCK, BLOCK_NS, RATE
from hw_node.microphones import Frames, choose


def written(path: Path, samples: list[list[int]], *, rate: int = RATE, width: int = 2) -> Path:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(len(samples[0]))
        file.setsampwidth(width)
        file.setframerate(rate)
        file.writeframes(np.array(samples, "<i2").tobytes())
    return path


def taken(word: str, count: int) -> tuple[Frames, list[int]]:
    """Return the frames of `count` blocks in one array, and the times of the blocks (ns)."""
    source = choose(word)
    assert source is not None
    source.open()
    blocks = [block for block in (source.next(1.0) for _ in range(count)) if block is not None]
    source.close()
    data = b"".join(block.payload for block in blocks)
    return np.frombuffer(data, "<i2").reshape(-1, 2), [block.header.t_mono_ns for block in blocks]


def test_the_tone_has_another_frequency_in_each_ear_and_no_click_between_blocks() -> None:
    frames, times_ns = taken("tone", 5)
    assert np.diff(times_ns).tolist() == [BLOCK_NS] * 4
    spectrum = np.abs(np.fft.rfft(frames, axis=0))
    peaks = spectrum.argmax(axis=0) * RATE / len(frames)
    assert peaks.tolist() == [500.0, 1000.0]
    assert (np.sort(spectrum, axis=0)[-2] < spectrum.max(axis=0) / 1000).all()


@pytest.mark.parametrize("channels", [1, 2])
def test_a_file_is_repeated_without_a_gap(tmp_path: Path, channels: int) -> None:
    ramp = [[i + 10_000 * channel for channel in range(channels)] for i in range(BLOCK + 100)]
    frames, _ = taken(f"file:{written(tmp_path / 'x.wav', ramp)}", 3)
    wanted = np.resize(np.arange(BLOCK + 100), 3 * BLOCK)
    assert (frames[:, 0] == wanted).all()
    assert (frames[:, 1] == wanted + (10_000 if channels == 2 else 0)).all()


@given(st.data())
def test_a_damaged_file_is_played_or_refused_with_a_sentence(data: st.DataObject) -> None:
    with TemporaryDirectory() as folder:
        path = written(Path(folder) / "x.wav", [[i, -i] for i in range(40)])
        whole = path.read_bytes()
        at = data.draw(st.integers(0, 60), label="place")
        wrong = data.draw(st.binary(max_size=8), label="bytes there")
        end = data.draw(st.integers(0, len(whole)), label="length")
        path.write_bytes((whole[:at] + wrong + whole[at + len(wrong) :])[:end])
        sentence = ""
        try:
            frames, _ = taken(f"file:{path}", 1)
        except WrongUsage as error:
            sentence = error.message
        else:
            assert len(frames) == BLOCK
        assert not sentence or re.search(r"cannot be played: \w[^.]*\. Give a WAV", sentence), sentence


def test_a_missing_file_is_refused() -> None:
    with pytest.raises(WrongUsage, match=r"/no/such.wav cannot be played: No such file .* Give a WAV file"):
        choose("file:/no/such.wav")
