"""Sounds for the simulated room, all of them computed, and what two ears on a turning head hear of one source.

Ears hear delay, distance, head shadow, noise, and the stepper motors, but no room echo. These are pure calculations on
blocks of sound; only `simulated_microphones` have a thread, which publishes them while a client subscribes.

The delay of a block changes linearly from its first to its last frame, and a block begins where the last one ended, so
that nothing clicks while head or source move. Each sound is stored with FINER times as many samples, so that straight
lines between them are exact enough for the places that the ears hear.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES, RobotData
from beatrix_zenoh.motion.gear import Arms, Gear
from beatrix_zenoh.motion.rotation import Rotation, Vector
from beatrix_zenoh.node import Component, Node, microphones_publisher
from beatrix_zenoh.node.sensors import BLOCK, BLOCK_NS, RATE, TITLE, Sensor, TimedSound, to_pcm

LOUDNESS: Final = 0.05
"""Root mean square of voice and noise at a distance of 1 m."""
FADE: Final = 240
"""Frames (5 ms) over which a sound begins and ends, so that it does not click."""
SEED: Final = 1

SHADOW: Final = 0.85
"""Largest part of the high frequencies that the head takes away: from the ear on the far side, 16 dB."""
SHADOW_HZ: Final = 2000.0
"""Corner frequency of the head shadow."""
FINER: Final = 8
"""Stored samples for each one of a sound."""
REACH: Final = 20
"""Samples over which filters extend to either side."""

Samples = npt.NDArray[np.float32]


def finer(samples: Samples) -> Samples:
    """Return a sound that is repeated without end with FINER times as many samples, shape (2, n): clear, and in the shadow.

    The shadow is a one-pole low-pass, forwards and backwards: it has no delay, which would move the source.
    """
    at = np.arange(-REACH, REACH + 1)
    shadow = np.exp(-math.tau * SHADOW_HZ / RATE) ** np.abs(at)
    shaded = _filtered(samples, shadow / shadow.sum())
    found = np.empty((2, FINER * len(samples)), np.float32)
    for phase in range(FINER):
        between = at + phase / FINER
        kernel = np.sinc(between) * np.cos(np.pi * between / (2 * REACH + 2)) ** 2
        found[:, phase::FINER] = _filtered(samples, kernel), _filtered(shaded, kernel)
    return found


def _filtered(samples: Samples, kernel: Floats) -> Samples:
    """Return a sound that is repeated without end after a filter with 2 * REACH + 1 taps."""
    filtered: Samples = np.convolve(np.pad(samples, REACH, mode="wrap"), kernel.astype(np.float32), "valid")
    return filtered


@dataclass(frozen=True, eq=False)
class PlayingSound:
    """A sound that is repeated until its end."""

    name: str
    began_s: float
    """time of its first sample, by the monotonic clock"""
    seconds: float
    samples: Samples = field(repr=False)
    """those of `finer`"""

    def left_s(self, now_s: float) -> float:
        """Return how much longer it plays (s)."""
        return max(0.0, self.began_s + self.seconds - now_s)

    def emitted(self, numbers: Floats) -> Floats:
        """Return the samples of these numbers, which may be fractions, shape (2, n): clear, and in the head's shadow.

        They are 0 before the sound begins and after its end.
        """
        fade = np.clip(np.minimum(numbers + 1, self.seconds * RATE - numbers) / FADE, 0.0, 1.0)
        places = numbers * FINER
        first = np.floor(places).astype(np.int64)
        one, other = (self.samples.take(first + after, axis=1, mode="wrap") for after in (0, 1))
        found: Floats = (one + (places - first) * (other - one)) * fade
        return found


def _noise(length: int, low_hz: float, high_hz: float, seed: int = SEED) -> Floats:
    """Return noise between two frequencies that can be repeated without a seam, root mean square 1."""
    random = np.random.default_rng(seed)
    hz = np.fft.rfftfreq(length, 1 / RATE)
    inside = (hz >= low_hz) & (hz <= high_hz)
    spectrum = inside * np.exp(1j * random.uniform(0, math.tau, len(hz)))
    samples: Floats = np.fft.irfft(spectrum, length)
    samples /= samples.std()
    return samples


def noise() -> Floats:
    """Return a second of noise from 100 Hz to 12 kHz."""
    return _noise(RATE, 100.0, 12_000.0)


def clap() -> Floats:
    """Return a clap, as short as that of two hands, and silence up to one second."""
    samples = _noise(RATE, 400.0, 12_000.0, SEED + 1)
    t_s = np.arange(RATE) / RATE - 0.01
    samples *= np.where(t_s < 0, 0.0, np.exp(-np.maximum(t_s, 0) / 0.008))
    samples *= 0.7 / LOUDNESS / np.abs(samples).max()
    return samples


SYLLABLE_S: Final = 0.5
PITCH_HZ: Final = 120.0


def voice() -> Floats:
    """Return half a second of a voice that says `sa`."""
    length = round(SYLLABLE_S * RATE)
    hiss = _noise(length, 2000.0, 12_000.0, SEED + 2)
    t_s = np.arange(length) / RATE
    # A pitch that falls a little, as in speech, in whole periods, so that the syllable can be repeated.
    turns = PITCH_HZ * (t_s + 0.03 * np.sin(math.tau * t_s / SYLLABLE_S) / 3)
    opens = np.clip(np.minimum(t_s - 0.08, 0.42 - t_s) / 0.04, 0.0, 1.0)
    hisses = np.clip(np.minimum(t_s, 0.1 - t_s) / 0.02, 0.0, 1.0)
    vowel: Floats = sum((np.sin(math.tau * k * turns) / k for k in range(1, 34)), start=np.zeros(length))
    said: Floats = opens * vowel / vowel.std() + (0.2 * hisses + 0.06 * opens) * hiss
    return said


GENERATORS: Final[dict[str, Callable[[], Floats]]] = {"clap": clap, "voice": voice, "noise": noise}


@cache
def generated(name: str) -> Samples:
    """Return the samples of a sound, as `finer` does; the first time takes some ms."""
    samples = GENERATORS[name]()
    return finer((samples * (LOUDNESS if name == "clap" else LOUDNESS / samples.std())).astype(np.float32))


SOUND: Final = 343.0
"""Speed of sound (m/s) at 20 degrees Celsius."""
NEAREST: Final = 0.1
"""Distance (m) below which a source becomes no louder."""
NOISE: Final = 0.001
"""Root mean square of the noise of a microphone; independent in both ears."""
MOTOR: Final = 0.008
"""Amplitude of the sound of a motor at MOTOR_HZ; both ears hear it equally, because the motors are below the neck."""
MOTOR_HZ: Final = 350.0
"""Microsteps per second of an arm at 30 deg/s, the default speed."""
HARMONICS: Final = 6


def _stepper() -> Floats:
    """Return one period of the tone of a motor, one for each microstep."""
    at = np.arange(1024) / 1024
    tone: Floats = sum((np.sin(math.tau * k * at) / k for k in range(1, HARMONICS + 1)), start=np.zeros(1024))
    return tone


NUMBERS: Final = np.arange(BLOCK, dtype=np.float64)
STEPPER: Final = _stepper()


@dataclass(frozen=True, eq=False)
class Hearing:
    """Ears, source and arms at one time."""

    ears: Floats
    """places (m) of the left and the right ear, shape (2, 3)"""
    axis: Floats
    """direction from the right to the left ear, length 1"""
    source: Vector
    """place (m) of the source"""
    arms: Arms
    """angles (rad)"""

    def distances(self) -> Floats:
        """Return the distances (m) of the source from the left and the right ear."""
        away: Floats = np.linalg.norm(self.source - self.ears, axis=1)
        return away

    def shadows(self) -> Floats:
        """Return the strength of the head shadow for both ears: 0 for a source on their side, SHADOW for the other."""
        along = (self.source - self.ears) @ self.axis * (1.0, -1.0)
        shadows: Floats = SHADOW * ((1 - along / np.maximum(self.distances(), 1e-9)) / 2) ** 2
        return shadows


def hearing(head: Rotation, arms: Arms, source: Vector, robot: RobotData = ROBOT) -> Hearing:
    """Return ears, source and arms for a head of this orientation (rows of its matrix)."""
    _, axis, up = np.array(head).T
    middle, half = up * robot.head.centre_height, axis * SIZES.ear_baseline / 2
    return Hearing(np.array((middle + half, middle - half)), axis, source, arms)


class Ears:
    """Computes block after block; remembers only where the last one ended."""

    def __init__(self, robot: RobotData = ROBOT, *, noise: float = NOISE, seed: int | None = None) -> None:
        """Store the arguments.

        Args:
            robot: values of the robot.
            noise: root mean square of the microphones' noise.
            seed: makes the noise repeatable.
        """
        self._noise = noise
        self._steps = Gear(robot.drive).steps_per_turn / math.tau * RATE / BLOCK
        """microsteps per second of an arm that turns by 1 rad in a block"""
        self._random = np.random.default_rng(seed)
        self._last: Hearing | None = None
        self._rates = np.zeros(3)
        """microsteps per second of each arm during the last block"""
        self._phases: Floats = np.zeros(3)

    def restart(self) -> None:
        """Forget where the last block ended, after a pause."""
        self._last, self._rates = None, np.zeros(3)

    def block(self, now: Hearing, sound: PlayingSound | None, begin_s: float) -> Samples:
        """Return the next BLOCK frames, shape (BLOCK, 2), which end with `now`.

        `sound` is that of the source, None for silence; `begin_s` is the time of the first frame, by the monotonic clock.
        """
        last, self._last = self._last or now, now
        heard = self._random.standard_normal((2, BLOCK), dtype=np.float32)
        heard *= self._noise
        if sound is not None:
            ways = zip(last.distances(), now.distances(), last.shadows(), now.shadows(), strict=True)
            for ear, (far, away, shade, shadow) in enumerate(ways):
                heard[ear] += heard_by(sound, begin_s, (far, away), (shade, shadow))
        before, self._rates = self._rates, np.abs(np.subtract(now.arms, last.arms)) * self._steps
        heard += self._motors(before, self._rates)
        return heard.T

    def _motors(self, before: Floats, after: Floats) -> Samples:
        """Return the sound of the motors: a tone with the frequency of each motor's steps, and the rattle of gears."""
        at = (NUMBERS + 1) / BLOCK
        rates = before + (after - before) * at[:, None]
        loud = MOTOR * np.sqrt(rates / MOTOR_HZ)
        turns = self._phases + after * (at * (BLOCK / RATE))[:, None]
        self._phases = turns[-1] % 1.0
        tones = STEPPER.take((turns * len(STEPPER)).astype(np.int64), mode="wrap")
        rattle = self._random.standard_normal(BLOCK) * np.sqrt(np.square(loud).sum(axis=1)) / 3
        motors: Samples = ((loud * tones).sum(axis=1) + rattle).astype(np.float32)
        return motors


def heard_by(
    sound: PlayingSound, begin_s: float, distances: tuple[float, float], shadows: tuple[float, float]
) -> Floats:
    """Return what one ear hears in a block; distances (m) and shadows are those at its begin and its end."""
    away, shadow = (first + (last - first) * NUMBERS / BLOCK for first, last in (distances, shadows))
    clear, shaded = sound.emitted((begin_s - sound.began_s - away / SOUND) * RATE + NUMBERS)
    heard: Floats = (clear + shadow * (shaded - clear)) / np.maximum(away, NEAREST)
    return heard


class SimulatedSound(TimedSound):
    """What both ears hear."""

    name = "simulation"

    def __init__(
        self, robot: RobotData, hearing: Callable[[], Hearing], playing: Callable[[], PlayingSound | None]
    ) -> None:
        super().__init__()
        self._hearing, self._playing = hearing, playing
        self._ears, self._due_ns = Ears(robot), 0

    def pcm(self, begin_ns: int) -> bytes:
        """Return what is heard in the block that began at this time."""
        if begin_ns != self._due_ns:
            self._ears.restart()
        self._due_ns = begin_ns + BLOCK_NS
        return to_pcm(self._ears.block(self._hearing(), self._playing(), begin_ns / 1e9))


def simulated_microphones(
    node: Node,
    robot: RobotData,
    hearing: Callable[[], Hearing],
    playing: Callable[[], PlayingSound | None],
) -> Component:
    """Return what publishes the sound of both ears; without a subscriber its thread sleeps.

    Args:
        node: the node whose name the sound has.
        robot: values of the robot.
        hearing: returns ears, source and arms at the last step of the physics.
        playing: returns the sound of the source, None for silence.
    """
    source = SimulatedSound(robot, hearing, playing)
    # Simulated ears hear no person, so no event says that they are on.
    key = keys.microphones(node.name, node.side)
    publisher = microphones_publisher(key, node.events, source.name, announce=False)
    return Sensor(TITLE, source, publisher, "", check_s=None)
