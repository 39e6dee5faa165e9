"""The microphones of the robot: the values of `--microphones`, and the component that publishes their sound.

A test tone or a WAV file can stand in for the microphones.
"""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh import threads, wav
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.node import Node, SoundBlock, microphones_publisher
from beatrix_zenoh.node.sensors import BLOCK, RATE, SILENT_S, TITLE, BlockClock, Sensor, SensorSource, to_pcm

TONES_HZ: Final = (500.0, 1000.0)
"""Frequencies of the test tone in the left and the right ear; a block contains whole periods of both."""
LOUDNESS: Final = 0.25
TONE, FILE, OFF = "tone", "file:", "off"
SILENCE: Final = f"The microphones are plugged in but have delivered no sound for {SILENT_S:g} s. Unplug them, and plug them in again."
SoundSource = SensorSource[SoundBlock]


class MicrophoneSensor(Sensor[SoundBlock]):
    """The two microphones of the robot."""

    def __init__(self, node: Node, source: SoundSource) -> None:
        wake = threading.Event()
        key = keys.microphones(node.name, node.side)
        publisher = microphones_publisher(key, node.events, source.name, wake.set, announce=True)
        super().__init__(TITLE, source, publisher, wake, SILENCE)

    def start_thread(self) -> threading.Thread:
        """Start the thread."""
        return threads.start(self.run, "microphones")


def choose(word: str) -> SoundSource | None:
    """Create the source that `--microphones` names; None for `off` and an empty text.

    No device is opened; a file is read once, to refuse a damaged one.

    Raises:
        WrongUsage: BAD_VALUE, with the mistake and the allowed values.
    """
    if word in ("", OFF):
        return None
    if word == TONE:
        return Tone()
    if word.startswith(FILE):
        source = SoundFile(Path(word.removeprefix(FILE)))
        if trouble := source.trouble():
            raise wrong(word, trouble)
        try:
            source.open()
        except NoAnswer as error:
            raise wrong(word, error.message) from error
        source.close()
        return source
    from hw_node.microphones import device  # noqa: PLC0415 - an extra

    try:
        return device.DeviceMicrophones(word, device.library())
    except WrongUsage as error:
        text = f"{error.message} Without it, `{TONE}` is a test tone, `{FILE}PATH` a WAV file, and `{OFF}` means none."
        raise wrong(word, text) from error


def wrong(word: str, text: str) -> WrongUsage:
    """Return the error for a value of --microphones."""
    return WrongUsage(Reason.BAD_VALUE, f"--microphones {quoted(word)}: {text}")


class Tone:
    """A test tone of 500 Hz in the left and of 1000 Hz in the right ear."""

    name: Final = "tone"

    def __init__(self) -> None:
        self._clock = BlockClock()
        t_s = np.arange(BLOCK)[:, None] / RATE
        self._block = to_pcm(LOUDNESS * np.sin(2 * np.pi * np.array(TONES_HZ) * t_s))

    def trouble(self) -> str:
        """Return an empty text: the tone is always available."""
        return ""

    def open(self) -> None:
        """Restart the clock."""
        self._clock.restart()

    def next(self, timeout_s: float) -> SoundBlock | None:
        """Wait for the next block and return it; None if it is complete after `timeout_s`."""
        begin_ns = self._clock.wait(timeout_s)
        if begin_ns is None:
            return None
        return SoundBlock(self._block, begin_ns, self.name, self._clock.dropped)

    def close(self) -> None:
        """Do nothing: there are no resources to free."""


class SoundFile:
    """A WAV file at 48 kHz, repeated; one channel is heard by both ears."""

    name: Final = "file"

    def __init__(self, path: Path) -> None:
        self._path, self._clock = path, BlockClock()
        self._samples = np.zeros((0, 2), "<i2")
        self._at = 0

    def trouble(self) -> str:
        """Return an error message if the file does not exist, else an empty text."""
        return "" if self._path.is_file() else f"{self._path} does not exist. Name a WAV file."

    def open(self) -> None:
        """Read the file, and begin with its first block."""
        try:
            self._samples = read(self._path)
        except (OSError, ValueError) as error:
            text = f"{self._path} cannot be played: {error}. Give a WAV file at {RATE} Hz, mono or stereo, of {wav.READABLE}."
            raise NoAnswer(Reason.BAD_VALUE, text) from error
        self._at = 0
        self._clock.restart()

    def next(self, timeout_s: float) -> SoundBlock | None:
        """Wait for the next block and return it; None if it is complete after `timeout_s`."""
        begin_ns = self._clock.wait(timeout_s)
        if begin_ns is None:
            return None
        rows = (self._at + np.arange(BLOCK)) % len(self._samples)
        self._at = int(rows[-1] + 1) % len(self._samples)
        return SoundBlock(self._samples[rows].tobytes(), begin_ns, self.name, self._clock.dropped)

    def close(self) -> None:
        """Forget the samples."""
        self._samples = np.zeros((0, 2), "<i2")


def read(path: Path) -> npt.NDArray[np.int16]:
    """Return the frames of a WAV file, shape (frames, 2); raises OSError or ValueError."""
    samples, rate = wav.read(path)
    channels = samples.shape[1]
    if channels > 2 or rate != RATE:
        raise ValueError(f"it has {rate} Hz and {channels} channel{'s' * (channels != 1)}")
    return np.broadcast_to(samples, (len(samples), 2))
