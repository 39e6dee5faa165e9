"""Two microphones on a sound device, through PortAudio. Only this module imports sounddevice."""

from __future__ import annotations

import queue
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Final, Protocol, cast

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.node import SoundBlock
from beatrix_zenoh.node.sensors import BEHIND, BLOCK, BLOCK_NS, RATE

CHANNELS: Final = 2
JUMP_NS: Final = BLOCK_NS // 2
"""A block whose time differs more than this from the expected one follows a gap."""
STEADY: Final = 0.02
"""Part of a smaller difference by which the expected time is corrected: the clock of a device is not this computer's."""

Device = Mapping[str, object]


class CallbackTime(Protocol):
    """Times of a block (s), by the clock of the device."""

    inputBufferAdcTime: float  # noqa: N815 - PortAudio's name
    currentTime: float  # noqa: N815 - PortAudio's name


class CallbackFlags(Protocol):
    """What has gone wrong before a block."""

    input_overflow: bool


Callback = Callable[[object, int, CallbackTime, CallbackFlags], None]


class Stream(Protocol):
    """The part of `sounddevice.RawInputStream` that is used here."""

    def start(self) -> None: ...
    def close(self) -> None: ...


class SoundDevice(Protocol):
    """The part of the module `sounddevice` that is used here."""

    PortAudioError: type[Exception]

    def query_devices(self) -> Sequence[Device]: ...
    def RawInputStream(  # noqa: N802 - sounddevice's name
        self,
        samplerate: float,
        blocksize: int,
        device: int,
        channels: int,
        dtype: str,
        *,
        callback: Callback,
    ) -> Stream: ...
    def _terminate(self) -> None: ...
    def _initialize(self) -> None: ...


def library() -> SoundDevice:
    """Import sounddevice; raises WrongUsage with what to install if it or PortAudio is missing."""
    try:
        import sounddevice  # noqa: PLC0415 - an extra; its import loads PortAudio
    except ImportError as error:
        text = 'Microphones need sounddevice: pip install ".[sound]" in the folder of BEATRIX.'
        raise WrongUsage(Reason.BAD_VALUE, text) from error
    except OSError as error:
        how = "sudo apt install libportaudio2" if sys.platform.startswith("linux") else "install PortAudio"
        text = f"The system library PortAudio is missing: {how}."
        raise WrongUsage(Reason.BAD_VALUE, text) from error
    return cast("SoundDevice", sounddevice)


class DeviceMicrophones:
    """Two microphones of one sound device, named by a part of its name or by its number."""

    name: Final = "device"

    def __init__(self, word: str, sound: SoundDevice) -> None:
        self._word, self._sound = word, sound
        self._blocks: queue.SimpleQueue[SoundBlock] = queue.SimpleQueue()
        self._stream: Stream | None = None
        self._due_ns = 0
        self._dropped = 0

    def trouble(self) -> str:
        """Return why the device cannot be used, else an empty text; looks for devices that were plugged in."""
        try:
            self._number()
        except NoAnswer:
            self._list_anew()
            try:
                self._number()
            except NoAnswer as error:
                return error.message
        return ""

    def _list_anew(self) -> None:
        """Let PortAudio list the devices again; it does so only when it is initialized."""
        self._sound._terminate()  # noqa: SLF001 - the documented way
        self._sound._initialize()  # noqa: SLF001

    def _number(self) -> int:
        """Return the number of the device; raises NoAnswer if there is none or several."""
        inputs = {
            number: device
            for number, device in enumerate(self._sound.query_devices())
            if _channels(device) >= CHANNELS
        }
        listed = "; ".join(f"{number} {device['name']}" for number, device in inputs.items())
        have = (
            f"Devices with two channels: {listed}."
            if inputs
            else "No device with two channels is plugged in."
        )
        if self._word.isdecimal():
            found = [number for number in inputs if number == int(self._word)]
        else:
            found = [
                number for number, one in inputs.items() if self._word.lower() in str(one["name"]).lower()
            ]
            exact = [number for number in found if str(inputs[number]["name"]).lower() == self._word.lower()]
            found = exact[:1] or found
        if len(found) == 1:
            return found[0]
        what = "is the name of several microphones" if found else "is no microphone"
        raise NoAnswer(Reason.NO_ANSWER, f"{quoted(self._word)} {what}. {have}")

    def open(self) -> None:
        """Start listening."""
        number = self._number()
        self._blocks, self._due_ns = queue.SimpleQueue(), 0
        try:
            self._stream = self._sound.RawInputStream(
                RATE, BLOCK, number, CHANNELS, "int16", callback=self._receive
            )
            self._stream.start()
        except (self._sound.PortAudioError, ValueError) as error:
            self.close()
            self._list_anew()
            self._number()  # raises if the device was unplugged
            text = f"The microphones cannot be opened with two channels at {RATE} Hz: {error}. End other programs that use them."
            raise NoAnswer(Reason.FAULT, text) from error

    def _receive(self, data: object, frames: int, times: CallbackTime, flags: CallbackFlags) -> None:
        """Enqueue a block; called on the thread of PortAudio, and must return at once."""
        now_ns = time.monotonic_ns()
        age_s = times.currentTime - times.inputBufferAdcTime
        # Some drivers report no times; a block that has just arrived began as long ago as it lasts.
        age_ns = round(age_s * 1e9) if times.inputBufferAdcTime > 0 and 0 < age_s < 1 else BLOCK_NS
        begin_ns = self._steady(now_ns - age_ns, overflow=flags.input_overflow)
        while self._blocks.qsize() > BEHIND:
            self._blocks.get_nowait()
            self._dropped += BLOCK
        self._blocks.put(SoundBlock(bytes(cast("bytes", data)), begin_ns, self.name, self._dropped))
        self._due_ns = begin_ns + frames * 1_000_000_000 // RATE

    def _steady(self, begin_ns: int, *, overflow: bool) -> int:
        """Return the time of a block's first frame without the jitter of callbacks, and count lost frames."""
        late_ns = begin_ns - self._due_ns
        if not self._due_ns or abs(late_ns) > JUMP_NS or overflow:
            if self._due_ns and (overflow or late_ns > 0):
                self._dropped += max(1, round(late_ns * RATE / 1e9))
            return max(begin_ns, self._due_ns)
        return self._due_ns + round(late_ns * STEADY)

    def next(self, timeout_s: float) -> SoundBlock | None:
        """Return the next block; None if none arrives within `timeout_s`."""
        try:
            return self._blocks.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def close(self) -> None:
        """Stop listening."""
        stream, self._stream = self._stream, None
        if stream is not None:
            stream.close()


def _channels(device: Device) -> int:
    channels = device["max_input_channels"]
    return channels if isinstance(channels, int) else 0
