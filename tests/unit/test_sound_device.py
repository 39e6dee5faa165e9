"""Microphones on a sound device, with a fake PortAudio: which device, the times of blocks, losses, refusals; and sound
without microphones: the test tone and WAV files."""

from __future__ import annotations

import re
import sys
import time
import wave
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType, SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import NoAnswer
from beatrix_zenoh.contract._generated.messages import SoundHeader
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.node import SensorFrame
from beatrix_zenoh.node.sensors import BEHIND, BLOCK, BLOCK_NS, RATE
from hw_node.microphones import DeviceMicrophones, Frames, choose


class FakeError(Exception):
    """In place of PortAudioError."""


class FakeSound(ModuleType):
    """A replacement for the module `sounddevice`, which lists devices only when it is initialized."""

    PortAudioError: type[Exception] = FakeError

    def __init__(self, *names: str) -> None:
        super().__init__("sounddevice")
        self.plugged = [{"name": name, "max_input_channels": 2} for name in names]
        self.known: list[dict[str, object]] = []
        self.refuses = ""
        self.asked: tuple[object, ...] = ()
        self.streams: list[Mock] = []
        """streams whose blocks the test delivers"""
        self._initialize()

    def _initialize(self) -> None:
        self.known = [{"name": "Speaker", "max_input_channels": 0}, *self.plugged]

    def _terminate(self) -> None:
        self.known = []

    def query_devices(self) -> Sequence[dict[str, object]]:
        return self.known

    def RawInputStream(  # noqa: N802
        self,
        samplerate: float,
        blocksize: int,
        device: int,
        channels: int,
        dtype: str,
        *,
        callback: object,
    ) -> Mock:
        self.asked = (samplerate, blocksize, device, channels, dtype)
        if self.refuses:
            raise FakeError(self.refuses)
        self.streams.append(Mock(callback=callback))
        return self.streams[-1]


def lost(block: SensorFrame) -> int:
    """Return the number of frames that were lost before a block."""
    assert isinstance(block.header, SoundHeader)
    return block.header.dropped


class Listening:
    """Open microphones, a clock, and the blocks of the test."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_ns = 10**12
        monkeypatch.setattr(time, "monotonic_ns", lambda: self.now_ns)
        self.sound = FakeSound("USB Audio")
        self.microphones = DeviceMicrophones("usb", self.sound)
        self.microphones.open()

    def deliver(self, begin_ns: int, *, overflow: bool = False, age_ns: int = BLOCK_NS) -> None:
        """Deliver a block whose first frame was heard at `begin_ns`."""
        self.now_ns = begin_ns + age_ns
        times = SimpleNamespace(inputBufferAdcTime=100.0 - age_ns / 1e9, currentTime=100.0)
        data = np.full((BLOCK, 2), 7, "<i2").tobytes()
        self.sound.streams[-1].callback(data, BLOCK, times, overflow)

    def blocks(self) -> list[SensorFrame]:
        found = []
        while (block := self.microphones.next(0.0)) is not None:
            found.append(block)
        return found


@pytest.fixture
def listening(monkeypatch: pytest.MonkeyPatch) -> Listening:
    return Listening(monkeypatch)


# -- which device ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("word", "number"),
    [("usb audio: left", 1), ("USB AUDIO", 3), ("webcam", 2), ("2", 2), ("Webcam", 2)],
)
def test_a_device_is_named_by_a_part_of_its_name_or_its_number(word: str, number: int) -> None:
    sound = FakeSound("USB Audio: left", "Webcam", "USB Audio")
    microphones = DeviceMicrophones(word, sound)
    assert microphones.trouble() == ""
    microphones.open()
    assert sound.asked == (48_000, 960, number, 2, "int16")
    assert sound.streams[0].start.called


@pytest.mark.parametrize(
    ("word", "teaches"),
    [
        ("usb", "is the name of several microphones. Devices with two channels: 1 USB one; 2 USB two."),
        ("Webcam", "is no microphone. Devices with two channels: 1 USB one; 2 USB two."),
        ("0", "is no microphone."),
        ("9", "is no microphone."),
        ("Mono", "is no microphone."),
    ],
)
def test_another_name_is_refused_with_the_devices(word: str, teaches: str) -> None:
    sound = FakeSound("USB one", "USB two")
    sound.plugged.append({"name": "Mono", "max_input_channels": 1})
    microphones = DeviceMicrophones(word, sound)
    assert teaches in microphones.trouble()
    with pytest.raises(NoAnswer, match=r"microphones?\."):
        microphones.open()
    microphones.close()


def test_a_device_that_is_plugged_in_later_is_found() -> None:
    sound = FakeSound()
    microphones = DeviceMicrophones("usb", sound)
    assert "No device with two channels is plugged in." in microphones.trouble()
    sound.plugged.append({"name": "USB Audio", "max_input_channels": 2})
    assert microphones.trouble() == ""
    sound.plugged.clear()
    sound._initialize()
    assert microphones.trouble() != ""


def test_a_device_that_cannot_be_opened_is_refused_with_the_cause() -> None:
    sound = FakeSound("USB Audio")
    sound.refuses = "Invalid sample rate"
    microphones = DeviceMicrophones("usb", sound)
    with pytest.raises(NoAnswer, match="two channels at 48000 Hz: Invalid sample rate"):
        microphones.open()
    microphones.close()


def test_a_device_that_was_unplugged_is_missing_and_not_in_use() -> None:
    sound = FakeSound("USB Audio")
    microphones = DeviceMicrophones("usb", sound)
    sound.plugged.clear()
    sound.refuses = "Unanticipated host error"
    assert microphones.trouble() == "", "the list of devices is old"
    with pytest.raises(NoAnswer, match="is no microphone"):
        microphones.open()


# -- blocks ----------------------------------------------------------------------------------------


def test_blocks_have_the_time_of_their_first_frame_without_the_jitter_of_the_driver(
    listening: Listening,
) -> None:
    begin_ns = 10**12
    for i, jitter_ns in enumerate((0, 3_000_000, -2_000_000, 4_000_000, 0)):
        listening.deliver(begin_ns + i * BLOCK_NS + jitter_ns)
    blocks = listening.blocks()
    assert blocks[0].header.t_mono_ns == begin_ns
    errors = [block.header.t_mono_ns - begin_ns - i * BLOCK_NS for i, block in enumerate(blocks)]
    assert max(map(abs, errors)) < 200_000
    assert {lost(block) for block in blocks} == {0}
    assert blocks[0].payload == np.full(2 * BLOCK, 7, "<i2").tobytes()


def test_the_clock_of_the_device_is_followed(listening: Listening) -> None:
    """A device that is 100 ppm fast: after 100 s the time is still right within a millisecond."""
    begin_ns, period_ns = 10**12, round(BLOCK_NS * 1.0001)
    for i in range(5000):
        listening.deliver(begin_ns + i * period_ns)
        (block,) = listening.blocks()
        assert abs(block.header.t_mono_ns - begin_ns - i * period_ns) < 1_000_000
        assert lost(block) == 0


@pytest.mark.parametrize("overflow", [False, True])
def test_a_gap_is_counted_in_frames(listening: Listening, overflow: bool) -> None:
    listening.deliver(10**12)
    listening.deliver(10**12 + 4 * BLOCK_NS, overflow=overflow)
    listening.deliver(10**12 + 5 * BLOCK_NS)
    blocks = listening.blocks()
    assert [lost(block) for block in blocks] == [0, 3 * BLOCK, 3 * BLOCK]
    assert [block.header.t_mono_ns for block in blocks] == [10**12 + i * BLOCK_NS for i in (0, 4, 5)]


def test_blocks_that_nobody_takes_are_dropped_and_counted(listening: Listening) -> None:
    for i in range(20):
        listening.deliver(10**12 + i * BLOCK_NS)
    blocks = listening.blocks()
    assert len(blocks) == BEHIND + 1
    assert lost(blocks[-1]) == (20 - BEHIND - 1) * BLOCK
    assert blocks[-1].header.t_mono_ns == 10**12 + 19 * BLOCK_NS


# -- what to install -------------------------------------------------------------------------------


def test_without_sounddevice_the_refusal_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    with pytest.raises(
        WrongUsage,
        match=r"--microphones \'USB': .*beatrix install sound.*apt install libportaudio2.*`tone` is a test tone",
    ):
        choose("USB")


# -- test tone and files ----------------------------------------------------------------------------


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
