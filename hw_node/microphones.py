"""The microphones of the robot: the values of `--microphones`, and the component that publishes their sound.

The microphones are those of a sound device, through PortAudio; a test tone or a WAV file can stand in for them. Only this
module imports sounddevice.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Final, Protocol, cast

import numpy as np
import numpy.typing as npt

from beatrix_zenoh import wav
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage, quoted, wrong_usage
from beatrix_zenoh.node import Component, Node, SensorFrame, microphones_publisher, sound_block
from beatrix_zenoh.node.sensors import (
    BEHIND,
    BLOCK,
    BLOCK_NS,
    RATE,
    SILENT_S,
    TITLE,
    Sensor,
    SensorSource,
    TimedSound,
    to_pcm,
)

TONES_HZ: Final = (500.0, 1000.0)
"""Frequencies of the test tone in the left and the right ear; a block contains whole periods of both."""
LOUDNESS: Final = 0.25
TONE, FILE, OFF = "tone", "file:", "off"
SILENCE: Final = f"The microphones are plugged in but have delivered no sound for {SILENT_S:g} s. Unplug them, and plug them in again."
Frames = npt.NDArray[np.int16]
"""Shape (frames, 2): left, right."""


def microphone_sensor(node: Node, source: SensorSource) -> Component:
    """Return the two microphones of the robot."""
    key = keys.microphones(node.name, node.side)
    publisher = microphones_publisher(key, node.events, source.name, announce=True)
    return Sensor(TITLE, source, publisher, SILENCE)


def choose(word: str) -> SensorSource | None:
    """Create the source that `--microphones` names; None for `off` and an empty text.

    No device is opened; a file is read now, to refuse a damaged one.

    Raises:
        WrongUsage: BAD_VALUE, with the mistake and the allowed values.
    """
    if word in ("", OFF):
        return None
    if word == TONE:
        return RepeatedSound(TONE, tone())
    if word.startswith(FILE):
        try:
            return RepeatedSound("file", read(Path(word.removeprefix(FILE))))
        except NoAnswer as error:
            raise wrong(word, error.message) from error
    try:
        return DeviceMicrophones(word, library())
    except WrongUsage as error:
        text = f"{error.message} Without it, `{TONE}` is a test tone, `{FILE}PATH` a WAV file, and `{OFF}` means none."
        raise wrong(word, text) from error


def wrong(word: str, text: str) -> WrongUsage:
    """Return the error for a value of --microphones."""
    return wrong_usage(f"--microphones {quoted(word)}: {text}")


def tone() -> Frames:
    """Return a block with a tone of 500 Hz in the left and of 1000 Hz in the right ear."""
    t_s = np.arange(BLOCK)[:, None] / RATE
    pcm = to_pcm(LOUDNESS * np.sin(2 * np.pi * np.array(TONES_HZ) * t_s))
    return np.frombuffer(pcm, "<i2").reshape(BLOCK, 2)


def read(path: Path) -> Frames:
    """Return the frames of a WAV file at 48 kHz; one channel is heard by both ears. Raises NoAnswer."""
    try:
        samples, rate = wav.read(path)
    except (OSError, ValueError) as error:
        raise unplayable(path, getattr(error, "strerror", None) or error) from error
    channels = samples.shape[1]
    if channels > 2 or rate != RATE:
        raise unplayable(path, f"it has {rate} Hz and {channels} channels")
    return np.broadcast_to(samples, (len(samples), 2))


def unplayable(path: Path, why: object) -> NoAnswer:
    """Return the error for a WAV file."""
    what = f"Give a WAV file at {RATE} Hz, mono or stereo, of {wav.READABLE}."
    return NoAnswer(Reason.BAD_VALUE, f"{path} cannot be played: {why}. {what}")


class RepeatedSound(TimedSound):
    """Sound that is repeated without end: the test tone, or a WAV file."""

    def __init__(self, name: str, frames: Frames) -> None:
        super().__init__()
        self.name, self._frames, self._at = name, frames, 0

    def pcm(self, begin_ns: int) -> bytes:  # noqa: ARG002
        """Return the next block."""
        rows = (self._at + np.arange(BLOCK)) % len(self._frames)
        self._at += BLOCK
        return self._frames[rows].tobytes()


CHANNELS: Final = 2
JUMP_NS: Final = BLOCK_NS // 2
"""A block whose time differs more than this from the expected one follows a gap."""
STEADY: Final = 0.02
"""Part of a smaller difference by which the expected time is corrected: the clock of a device is not this computer's."""


class CallbackTime(Protocol):
    """Times of a block (s), by the clock of the device."""

    inputBufferAdcTime: float  # noqa: N815 - PortAudio's name
    currentTime: float  # noqa: N815 - PortAudio's name


def library() -> ModuleType:
    """Import sounddevice; raises WrongUsage with what to install if it or PortAudio is missing."""
    try:
        import sounddevice  # noqa: PLC0415 - an extra; its import loads PortAudio
    except (ImportError, OSError) as error:
        text = (
            "Microphones need sounddevice (`beatrix install sound`) and the system library "
            "PortAudio, on Linux `sudo apt install libportaudio2`."
        )
        raise wrong_usage(text) from error
    return cast("ModuleType", sounddevice)


class DeviceMicrophones(SensorSource):
    """Two microphones of one sound device, named by a part of its name or by its number."""

    name = "device"

    def __init__(self, word: str, sound: ModuleType) -> None:
        """`sound` is the module `sounddevice`."""
        self._word, self._sound = word, sound
        self._blocks: queue.SimpleQueue[SensorFrame] = queue.SimpleQueue()
        self._stop: Callable[[], None] = lambda: None
        self._due_ns = 0
        self._dropped = 0

    def trouble(self) -> str:
        """Return why the device cannot be used, else an empty text; looks for devices that were plugged in."""
        trouble = ""
        for _ in range(2):
            try:
                self._number()
            except NoAnswer as error:
                trouble = error.message
                self._list_anew()
            else:
                return ""
        return trouble

    def _list_anew(self) -> None:
        """Let PortAudio list the devices again; it does so only when it is initialized."""
        self._sound._terminate()  # noqa: SLF001 - the documented way
        self._sound._initialize()  # noqa: SLF001

    def _number(self) -> int:
        """Return the number of the device; raises NoAnswer if there is none or several."""
        devices = enumerate(self._sound.query_devices())
        inputs = {
            number: str(device["name"])
            for number, device in devices
            if device["max_input_channels"] >= CHANNELS
        }
        word = self._word.lower()
        found = [number for number, name in inputs.items() if word in (str(number), name.lower())][:1]
        if not found and not word.isdecimal():
            found = [number for number, name in inputs.items() if word in name.lower()]
        if len(found) == 1:
            return found[0]
        listed = "; ".join(f"{number} {name}" for number, name in inputs.items())
        have = (
            f"Devices with two channels: {listed}."
            if inputs
            else "No device with two channels is plugged in."
        )
        what = "is the name of several microphones" if found else "is no microphone"
        raise NoAnswer(Reason.NO_ANSWER, f"{quoted(self._word)} {what}. {have}")

    def open(self) -> None:
        """Start listening."""
        number = self._number()
        self._blocks, self._due_ns = queue.SimpleQueue(), 0
        try:
            stream = self._sound.RawInputStream(
                RATE, BLOCK, number, CHANNELS, "int16", callback=self._receive
            )
            self._stop = stream.close
            stream.start()
        except (self._sound.PortAudioError, ValueError) as error:
            self.close()
            self._list_anew()
            self._number()  # raises if the device was unplugged
            text = f"The microphones cannot be opened with two channels at {RATE} Hz: {error}. End other programs that use them."
            raise NoAnswer(Reason.FAULT, text) from error

    def _receive(self, data: bytes, frames: int, times: CallbackTime, faults: object) -> None:
        """Enqueue a block, on the thread of PortAudio; `faults` is true if frames before it were lost."""
        now_ns = time.monotonic_ns()
        age_s = times.currentTime - times.inputBufferAdcTime
        # Some drivers report no times; a block that has just arrived began as long ago as it lasts.
        age_ns = round(age_s * 1e9) if times.inputBufferAdcTime > 0 and 0 < age_s < 1 else BLOCK_NS
        begin_ns = self._steady(now_ns - age_ns, overflow=bool(faults))
        while self._blocks.qsize() > BEHIND:
            self._blocks.get_nowait()
            self._dropped += BLOCK
        self._blocks.put(sound_block(bytes(data), begin_ns, self.name, self._dropped))
        self._due_ns = begin_ns + frames * 1_000_000_000 // RATE

    def _steady(self, begin_ns: int, *, overflow: bool) -> int:
        """Return the time of a block's first frame without the jitter of callbacks, and count lost frames."""
        late_ns = begin_ns - self._due_ns
        if not self._due_ns or abs(late_ns) > JUMP_NS or overflow:
            if self._due_ns and (overflow or late_ns > 0):
                self._dropped += max(1, round(late_ns * RATE / 1e9))
            return max(begin_ns, self._due_ns)
        return self._due_ns + round(late_ns * STEADY)

    def next(self, timeout_s: float) -> SensorFrame | None:
        """Return the next block; None if none arrives within `timeout_s`."""
        try:
            return self._blocks.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def close(self) -> None:
        """Stop listening."""
        self._stop()
        self._stop = lambda: None
