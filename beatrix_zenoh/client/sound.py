"""Sound of a robot's two microphones: blocks in the order in which they were heard, and pieces without gaps."""

from __future__ import annotations

import base64
import io
import time
import wave
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt
from msgspec import structs

from beatrix_zenoh import wav
from beatrix_zenoh.bus import Received
from beatrix_zenoh.client.degrees import checked_number
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Arrival, Subscription
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import SoundHeader
from beatrix_zenoh.contract.errors import wrong_usage

SILENCE_S: Final = 5.0
"""Time limit (s) for a block of sound; a device may need seconds for the first one."""
BLOCKS: Final = 500
"""Queue length for sound: ten seconds."""
SENT_S, SENT_HZ = 10.0, 48_000
"""Longest sound (s) that one message to a simulation can hold, and its rate."""
ANEW_NS: Final = 500_000_000
"""Time (ns) without a block in order after which a block begins a new sequence."""
AHEAD_NS: Final = 1_000_000_000
"""A block may be ahead by this time (ns): a network may hold blocks back, and then deliver them at once."""
_FRAME: Final = 4
"""Bytes of a frame: two int16."""
_SEQS: Final = 2**32
_FULL_SCALE: Final = 32768.0
LONGEST_S: Final = 60.0
"""Longest piece of sound."""
_QUIETEST: Final = 1e-6
"""Root mean square that counts as silence, -120 dB."""

Samples = npt.NDArray[np.float32]


class Sound(SoundHeader, frozen=True, kw_only=True, eq=False):
    """A piece of sound from both ears.

    `seq` is the number of its (first) block: a gap shows lost ones. `t_mono_ns` and `t_wall_ns` are the clocks of the
    robot at the first frame (ns), `rate` frames per second, `dropped` the frames that the robot's device has lost since
    its node started. `source` is the origin: `device`, `file`, `tone` or `simulation`.
    """

    samples: Samples
    """shape (frames, 2), left first, from -1 to 1; read-only"""
    lost: int = 0
    """frames of `samples` that never arrived, and are zero"""

    @property
    def t(self) -> float:
        """Time (s) of the first frame by the robot's monotonic clock, as in positions."""
        return self.t_mono_ns / 1e9

    @property
    def seconds(self) -> float:
        """Duration (s)."""
        return len(self.samples) / self.rate

    @property
    def left(self) -> Samples:
        """Samples of the left ear."""
        return self.samples[:, 0]

    @property
    def right(self) -> Samples:
        """Samples of the right ear."""
        return self.samples[:, 1]

    @property
    def level(self) -> tuple[float, float]:
        """Loudness of the left and the right ear, dB: 0 is a square wave at full scale, -120 is silence.

        Frames that were lost do not count.
        """
        squares = np.square(self.samples, dtype=np.float64).sum(axis=0) / max(
            1, len(self.samples) - self.lost
        )
        left, right = (20 * np.log10(max(_QUIETEST, float(square) ** 0.5)) for square in squares)
        return float(left), float(right)

    def save(self, path: str | Path) -> None:
        """Write a WAV file of 16 bits; raises OSError."""
        Path(path).write_bytes(self._wav())

    def _wav(self) -> bytes:
        file = io.BytesIO()
        with wave.open(file, "wb") as out:
            out.setnchannels(2)
            out.setsampwidth(2)
            out.setframerate(self.rate)
            out.writeframes(
                np.clip(np.rint(self.samples * _FULL_SCALE), -_FULL_SCALE, _FULL_SCALE - 1)
                .astype("<i2")
                .tobytes()
            )
        return file.getvalue()

    def __repr__(self) -> str:
        left, right = self.level
        lost = f", {self.lost} frames lost" if self.lost else ""
        return (
            f"<{self.seconds:.2f} s of sound ({self.source}), left {left:.0f} dB, right {right:.0f} dB{lost}>"
        )

    def _repr_html_(self) -> str:
        """Return a player, which a notebook shows."""
        data = base64.b64encode(self._wav()).decode()
        return f'<audio controls src="data:audio/wav;base64,{data}"></audio>'


@dataclass
class Faults:
    """Blocks that a subscription has counted while they were read."""

    lost: int = 0
    """missing in the sequence numbers: lost by network or router, or by this program, which read too slowly"""
    duplicated: int = 0
    """arrived again just after the first time; skipped"""
    late: int = 0
    """arrived after a newer block, or has an impossible number or time; skipped"""
    dropped: int = 0
    """frames, not blocks, that the robot's device has lost"""

    def __str__(self) -> str:
        counts = f"{self.lost} blocks lost, {self.duplicated} duplicated, {self.late} late"
        return f"{counts}; {self.dropped} frames dropped by the robot"


@dataclass
class BlockOrder:
    """Finds lost, duplicated and late blocks of one robot by their sequence numbers.

    A block whose number or time is behind the newest, or further ahead than the time that has passed on this computer, is
    not heard. If none fits for ANEW_NS, the node was restarted, or an impossible block came first: the next one begins a
    new sequence. Times of the wall clock are not used, because they may be wrong.
    """

    faults: Faults = field(default_factory=Faults)
    _newest: Sound | None = None
    _newest_ns: int = 0
    """arrival of `_newest`, by the monotonic clock of this computer"""

    def accept(self, block: Sound, arrived_ns: int) -> bool:
        """Count a block; return whether it is in order, so that the program should hear it.

        `arrived_ns`: its arrival by the monotonic clock of this computer.
        """
        newest = self._newest
        passed_ns = arrived_ns - self._newest_ns
        step = 1 if newest is None else (block.seq - newest.seq + _SEQS // 2) % _SEQS - _SEQS // 2
        if newest is not None:
            block_ns = len(newest.samples) * 1_000_000_000 // newest.rate
            ahead_ns = max((step - 1) * block_ns, block.t_mono_ns - newest.t_mono_ns) - passed_ns
            if step <= 0 or block.t_mono_ns <= newest.t_mono_ns or ahead_ns > AHEAD_NS:
                if (block.seq, block.t_mono_ns) == (newest.seq, newest.t_mono_ns):
                    self.faults.duplicated += 1
                    return False
                if passed_ns < ANEW_NS:
                    self.faults.late += 1
                    return False
                step, newest = 1, None
        self.faults.lost += step - 1
        if newest is not None:
            self.faults.dropped += max(0, block.dropped - newest.dropped)
        self._newest, self._newest_ns = block, arrived_ns
        return True


class Microphones(Subscription[Sound]):
    """Blocks of sound from one robot, in order; `faults` counts what was lost, duplicated or late."""

    def __init__(self, client: Client, robot: str, side: str, *, timeout_s: float | None = SILENCE_S) -> None:
        """Subscribe, which switches the microphones on; see `Subscription` for `timeout_s` and errors."""
        key = keys.microphones(robot, side)
        super().__init__(client, key, sound, timeout_s=timeout_s, length=BLOCKS, bus=client.media)
        self._order = BlockOrder()

    @property
    def faults(self) -> Faults:
        """Lost, duplicated and late blocks up to the newest block that was read."""
        return replace(self._order.faults)

    def _read(self, received: Received) -> Arrival[Sound] | None:
        arrival = super()._read(received)
        heard = arrival is not None and self._order.accept(arrival.value, received.t_mono_ns)
        return arrival if heard else None

    def listen(self, seconds: float) -> Sound:
        """Return the next `seconds` of sound as one piece, with zeros in place of lost blocks; see `Sound.lost`.

        Raises:
            NoAnswer: TIMED_OUT, no block arrived for the time limit of the subscription, or blocks with impossible times.
            WrongUsage: BAD_VALUE, `seconds` is not above 0, or above 60.
        """
        if not 0 < checked_number("seconds", seconds, "s") <= LONGEST_S:
            text = f"seconds is {seconds:g}: give more than 0, at most {LONGEST_S:g} s; for longer, iterate over robot.microphones()."
            raise wrong_usage(text)
        first = self.next()
        wanted = max(1, round(seconds * first.rate))
        blocks, end_ns = [first], first.t_mono_ns + wanted * 1e9 / first.rate
        deadline_s = time.monotonic() + seconds + SILENCE_S
        while blocks[-1].t_mono_ns + len(blocks[-1].samples) * 1e9 / first.rate < end_ns - 0.5e9 / first.rate:
            if time.monotonic() > deadline_s:
                raise self._silence(SILENCE_S)
            blocks.append(self.next())
        return joined(blocks, wanted)


def mono(path: Path) -> bytes:
    """Return the sound of a WAV file as the attachment of `samples`: mono, int16, at 48 kHz.

    Raises:
        WrongUsage: BAD_VALUE, the file cannot be read, has another format, or is too long.
    """
    try:
        frames, rate = wav.read(path, SENT_S)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        text = (
            f"{path} cannot be played: {why}. Give a WAV file of {wav.READABLE}, at most {SENT_S:g} s long."
        )
        raise wrong_usage(text) from error
    at = np.arange(round(len(frames) * SENT_HZ / rate)) * (rate / SENT_HZ)
    heard = np.interp(at, np.arange(len(frames)), frames.mean(axis=1))
    samples: npt.NDArray[np.int16] = np.rint(heard).astype("<i2")
    return samples.tobytes()


def joined(blocks: list[Sound], wanted: int) -> Sound:
    """Return `wanted` frames from the first block on, each block at the place of its time, with zeros in the gaps."""
    first = blocks[0]
    samples, heard = np.zeros((wanted, 2), np.float32), np.zeros(wanted, bool)
    at = 0
    for one in blocks:
        begin = round((one.t_mono_ns - first.t_mono_ns) * first.rate / 1e9)
        # The clock of a device is not that of the robot: only a gap of half a block and more is a lost block.
        at = at if abs(begin - at) < len(one.samples) / 2 else begin
        part = one.samples[: max(0, wanted - at)]
        samples[at : at + len(part)], heard[at : at + len(part)] = part, True
        at += len(one.samples)
    samples.setflags(write=False)
    return structs.replace(first, samples=samples, lost=wanted - int(heard.sum()), dropped=blocks[-1].dropped)


def sound(client: Client, received: Received) -> Sound | None:
    """Convert a publication to a block; log a warning and return None if it is not sound with a valid header."""
    header = client.read(received.header, SoundHeader)
    if header is None:
        return None
    if not received.payload or len(received.payload) % _FRAME or not header.rate:
        text = f"ignored: {len(received.payload)} bytes at {header.rate} Hz are no sound. Another program publishes on this key: end it."
        client.report(received, text)
        return None
    samples = np.frombuffer(received.payload, "<i2").reshape(-1, 2).astype(np.float32) / np.float32(
        _FULL_SCALE
    )
    samples.setflags(write=False)
    return Sound(samples=samples, **structs.asdict(header))
