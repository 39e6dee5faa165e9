"""Sound in recordings: blocks as rows, and the blocks of a file as one WAV file."""

from __future__ import annotations

import wave
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.client.sound import Sound
from beatrix_zenoh.recording.rows import Numbers, RecordingRow, SoundRow, of_robot

FULL_SCALE: Final = 32768
FRAME: Final = 4
"""Bytes of a frame: two int16."""
PIECES: Final = 2
"""Points of the drawn waveform in each block: one every 10 ms."""
ZEROS: Final = 48_000
"""Frames of silence that are written at once, so that a long gap needs no memory."""


class RecordedBlock(NamedTuple):
    """A recorded block, and its time (ns since 1970) by the clock of the recording computer."""

    time_ns: int
    pcm: bytes
    """int16, little-endian, left and right by turns"""
    rate: int
    seq: int


def rows_of(place: Place, block: Sound, time_ns: int) -> Iterator[RecordingRow]:
    """Yield a block as it was published, the level of each ear (dB), and its waveform for plots.

    The waveform is the largest amplitude of 10 ms: that of the left ear upwards, that of the right ear downwards.
    """
    path = of_robot(place, "microphones")
    samples = np.rint(block.samples * FULL_SCALE).astype("<i2")  # exact: the published numbers again
    yield SoundRow(path, time_ns, samples.tobytes(), block.rate, block.seq)
    yield Numbers(f"{path}/level", time_ns, block.level)
    begin = 0
    for piece in np.array_split(np.abs(block.samples), PIECES):
        if len(piece):
            after_ns = begin * 1_000_000_000 // block.rate
            left, right = piece.max(axis=0).tolist()
            yield Numbers(f"{path}/wave", time_ns + after_ns, (left, -right))
            begin += len(piece)


def write_wav(path: Path, blocks: Iterable[RecordedBlock]) -> tuple[float, float]:
    """Write blocks, in the order of time, as a WAV file in which each is at its time; what is missing is silence.

    Returns the duration (s), and how much of it is missing (s).

    Raises:
        OSError: the file cannot be written.
    """
    at = lost = rate = 0
    first_ns: int | None = None
    with path.open("wb") as file, wave.open(file, "wb") as out:  # wave leaves a file open that it cannot make
        for block in blocks:
            if first_ns is None:
                first_ns, rate = block.time_ns, block.rate
                out.setnchannels(2)
                out.setsampwidth(2)
                out.setframerate(rate)
            frames = len(block.pcm) // FRAME
            begin = round((block.time_ns - first_ns) * rate / 1e9)
            if begin < at - frames / 2:
                continue  # the block of a second program, or one that came twice
            # A device's clock is not that of the computer: only a gap of half a block and more is a lost block.
            if begin > at + frames / 2:
                lost += begin - at
                silence(out, begin - at)
                at = begin
            out.writeframesraw(block.pcm)
            at += frames
        if first_ns is None:
            raise ValueError("no blocks")
    return at / rate, lost / rate


def silence(out: wave.Wave_write, frames: int) -> None:
    """Write frames of zeros."""
    while frames > 0:
        out.writeframesraw(bytes(FRAME * min(frames, ZEROS)))
        frames -= ZEROS
