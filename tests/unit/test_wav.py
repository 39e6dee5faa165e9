"""WAV files: each usual format is played, each other one is refused by its name, whatever the version of Python."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from beatrix_zenoh import wav
from beatrix_zenoh.client.sound import mono
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from hw_node import microphones

RATE = 48_000
FRAMES = np.random.default_rng(1).integers(-(2**15), 2**15, (960, 2)).astype("<i2")
FRAMES[:2] = [[-(2**15), 2**15 - 1], [0, -1]]
PCM, FLOAT = 1, 3
GUID = bytes.fromhex("000000001000800000aa00389b71")


def as_bits(kind: int, bits: int) -> bytes:
    """Return FRAMES in another format."""
    if kind == FLOAT:
        return (FRAMES / 32768).astype(f"<f{bits // 8}").tobytes()
    shifted = FRAMES.astype("<i8") << (bits - 16)
    return shifted.view(np.uint8).reshape(-1, 8)[:, : bits // 8].tobytes()


def file_of(kind: int, bits: int, data: bytes, *, extensible: bool = False, before: bytes = b"") -> bytes:
    """Return a WAV file of two channels; `before` are chunks between header and sound."""
    width = 2 * bits // 8
    header = struct.pack("<HHIIHH", 0xFFFE if extensible else kind, 2, RATE, RATE * width, width, bits)
    if extensible:
        header += struct.pack("<HHIH", 22, bits, 3, kind) + GUID
    chunks = b"fmt " + struct.pack("<I", len(header)) + header + before
    chunks += b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


@pytest.mark.parametrize("extensible", [False, True])
@pytest.mark.parametrize(("kind", "bits"), [(PCM, 16), (PCM, 24), (PCM, 32), (FLOAT, 32), (FLOAT, 64)])
def test_every_usual_format_gives_the_same_numbers(
    tmp_path: Path, kind: int, bits: int, *, extensible: bool
) -> None:
    path = tmp_path / "x.wav"
    note = b"LIST" + struct.pack("<I", 3) + b"abc\0"
    path.write_bytes(file_of(kind, bits, as_bits(kind, bits), extensible=extensible, before=note))
    found = wav.read(path)
    assert found.rate == RATE
    assert np.array_equal(found.samples, FRAMES)
    assert mono(path) == np.rint(FRAMES.mean(axis=1)).astype("<i2").tobytes()
    assert np.array_equal(microphones.read(path), FRAMES)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (file_of(PCM, 8, bytes(8)), "it has whole numbers of 8 bits"),
        (file_of(6, 8, bytes(8)), "it has A-law of 8 bits"),
        (file_of(7, 8, bytes(8), extensible=True), "it has µ-law of 8 bits"),
        (file_of(0x161, 16, bytes(8)), "it has sound of format 353 of 16 bits"),
        (file_of(FLOAT, 16, bytes(8)), "it has floating-point numbers of 16 bits"),
        (file_of(PCM, 16, b""), "it contains no sound"),
        (file_of(PCM, 16, bytes(800))[:-4], "it ends before its sound does"),
        (b"OggS" + bytes(100), "it is no WAV file"),
        (file_of(PCM, 16, bytes(8))[:30], "it is no WAV file, or its header is damaged"),
    ],
)
def test_every_other_file_is_refused_by_its_true_name(tmp_path: Path, content: bytes, why: str) -> None:
    path = tmp_path / "x.wav"
    path.write_bytes(content)
    with pytest.raises(WrongUsage, match=f"cannot be played: {why}"):
        mono(path)
    with pytest.raises(NoAnswer, match=f"cannot be played: {why}"):
        microphones.read(path)


def test_numbers_beyond_full_scale_are_cut_off(tmp_path: Path) -> None:
    """A file of floating-point numbers may hold any number."""
    path = tmp_path / "x.wav"
    path.write_bytes(file_of(FLOAT, 64, np.array([2.0, -2.0, np.inf, -np.inf, np.nan, 1e308]).tobytes()))
    assert wav.read(path).samples.ravel().tolist() == [32767, -32768, 32767, -32768, 0, 32767]


def test_a_long_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "x.wav"
    path.write_bytes(file_of(PCM, 16, bytes(4 * RATE * 11)))
    with pytest.raises(WrongUsage, match=r"cannot be played: it lasts 11.0 s\. .* at most 10 s long"):
        mono(path)
