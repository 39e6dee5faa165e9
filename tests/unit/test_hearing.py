"""Two ears on a turning head: delay, level, head shadow and motors, and the directions that follow from them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES
from beatrix_zenoh.motion.rotation import Rotation, Vector
from beatrix_zenoh.node.sensors import BLOCK, RATE
from sim_node.hearing import (
    GENERATORS,
    LOUDNESS,
    SOUND,
    Ears,
    Hearing,
    PlayingSound,
    finer,
    generated,
    heard_by,
    hearing,
)

REST = (0.0, 0.0, 0.0)
HEIGHT = ROBOT.head.centre_height
LONG_S = 60.0


def turned(yaw_deg: float) -> Rotation:
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return (c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)


def at(bearing_deg: float, away: float = 1.15) -> Vector:
    """Return a place at the height of the ears, at a distance (m) from the middle of the head; left is positive."""
    bearing = math.radians(bearing_deg)
    return away * math.cos(bearing), away * math.sin(bearing), HEIGHT


def played(name: str) -> PlayingSound:
    return PlayingSound(name, 0.0, LONG_S, generated(name))


def hum(hz: float) -> PlayingSound:
    return PlayingSound(
        "hum", 0.0, LONG_S, finer(np.sin(math.tau * hz * np.arange(RATE) / RATE).astype(np.float32))
    )


def listen(ears: Ears, scenes: list[Hearing], sound: PlayingSound | None) -> Floats:
    """Return what the ears hear during the scenes, one block for each, from the second second of the sound on."""
    return np.concatenate([ears.block(one, sound, 1 + i * BLOCK / RATE) for i, one in enumerate(scenes)])


def delay_s(left: Floats, right: Floats, upsampled: int = 8) -> float:
    """Return how much later (s) the right ear hears the same: the peak of the cross-correlation with phase transform.

    Knapp and Carter, The generalized correlation method for estimation of time delay, 1976.
    """
    window = np.hanning(len(left))
    length = 2 * len(left)
    cross = np.fft.rfft(right * window, length) * np.conj(np.fft.rfft(left * window, length))
    correlation = np.fft.irfft(cross / (np.abs(cross) + 1e-12), length * upsampled)
    most = math.ceil(SIZES.ear_baseline / SOUND * RATE * upsampled) + 1
    peak = np.concatenate([correlation[-most:], correlation[: most + 1]]).argmax() - most
    return float(peak) / (RATE * upsampled)


def bearing_deg(sound: Floats) -> float:
    """Return the direction (deg, left is positive) of a source, from the delay between both ears."""
    sine = delay_s(sound[:, 0], sound[:, 1]) * SOUND / SIZES.ear_baseline
    return math.degrees(math.asin(max(-1.0, min(1.0, sine))))


# -- delay, level, shadow --------------------------------------------------------------------------


@given(st.floats(0.3, 3.0), st.floats(0.0, 1.0))
def test_delay_and_level_are_those_of_the_distance(away: float, fraction: float) -> None:
    begin_s = 1 + fraction / RATE
    heard = heard_by(hum(750.0), begin_s, (away, away), (0.0, 0.0))
    t_s = begin_s + np.arange(BLOCK) / RATE - away / SOUND
    assert np.abs(heard - np.sin(math.tau * 750.0 * t_s) / away).max() < 0.004 / away


def test_the_far_ear_misses_the_high_frequencies_and_hears_the_low_ones() -> None:
    scene = hearing(turned(0), REST, at(90))

    def difference_db(hz: float) -> float:
        sound = listen(Ears(noise=0.0), [scene] * 4, hum(hz))
        left, right = sound.std(axis=0) * scene.distances()
        return float(20 * np.log10(left / right))

    assert difference_db(100.0) == pytest.approx(0.0, abs=0.1)
    assert difference_db(9000.0) > 10.0
    assert difference_db(2000.0) == pytest.approx(difference_db(9000.0) / 2, abs=3.0)


# -- no clicks -------------------------------------------------------------------------------------


@given(
    st.floats(-150, 150),
    st.floats(-90, 90),
    st.floats(-180, 180),
    st.sampled_from([300.0, 1000.0, 3000.0]),
)
@settings(max_examples=15, deadline=None)
def test_a_turning_head_hears_no_click(begin: float, speed: float, bearing: float, hz: float) -> None:
    """The curvature of a tone is bounded by its frequency: a step or a kink between blocks would exceed it."""
    scenes = [hearing(turned(begin + speed * i * BLOCK / RATE), REST, at(bearing)) for i in range(8)]
    sound = listen(Ears(noise=0.0), scenes, hum(hz))
    nearest = min(min(one.distances()) for one in scenes)
    fastest = math.tau * hz * (1 + 0.2 / SOUND) / RATE
    assert np.abs(np.diff(sound, axis=0)).max() <= fastest / nearest * 1.03 + 2e-4
    assert np.abs(np.diff(sound, 2, axis=0)).max() <= fastest**2 / nearest * 1.1 + 2e-3


# -- noise and motors ------------------------------------------------------------------------------


@pytest.mark.parametrize("speed_deg", [30.0, 60.0, 90.0])
def test_turning_arms_hum_with_the_frequency_of_their_steps_equally_in_both_ears(speed_deg: float) -> None:
    def scene(i: int) -> Hearing:
        angle = math.radians(speed_deg) * i * BLOCK / RATE
        return hearing(turned(0), (angle, angle, angle), at(0))

    sound = listen(Ears(noise=0.0, seed=1), [scene(i) for i in range(50)], None)
    assert (sound[:, 0] == sound[:, 1]).all()
    spectrum = np.abs(np.fft.rfft(sound[10 * BLOCK :, 0]))
    loudest_hz = spectrum.argmax() * RATE / (40 * BLOCK)
    assert loudest_hz == pytest.approx(speed_deg / 360 * 200 * 8 * 68 / 26, abs=2.0)


# -- directions ------------------------------------------------------------------------------------


TEN = (-45, -35, -25, -15, -5, 5, 15, 25, 35, 45)
WINDOW = 4
"""Blocks from which a direction is found: 80 ms."""


@pytest.mark.parametrize("bearing", TEN)
@pytest.mark.parametrize(("name", "speed_deg"), [("noise", 30.0), ("voice", 0.0)])
def test_a_direction_is_found_within_3_degrees_at_10_db(name: str, speed_deg: float, bearing: int) -> None:
    """With head shadow, and the noise of the motors at this speed of the arms; the median of nine windows.

    A voice has little sound above 4 kHz: motors that run, which both ears hear at the same time, pull it to the middle.
    """
    arms = [(math.radians(speed_deg * i * BLOCK / RATE),) * 3 for i in range(10 * WINDOW)]
    scenes = [hearing(turned(0), one, at(bearing)) for one in arms]
    noise = LOUDNESS / 1.15 / math.sqrt(10)
    sound = listen(Ears(noise=noise, seed=bearing + 100), scenes, played(name))
    windows = sound[WINDOW * BLOCK :].reshape(9, WINDOW * BLOCK, 2)
    assert np.median([bearing_deg(one) for one in windows]) == pytest.approx(bearing, abs=3.0)


# -- sounds ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", GENERATORS)
def test_a_sound_fits_into_16_bits_and_repeats_without_a_click(name: str) -> None:
    samples = generated(name)[0]
    assert np.abs(samples).max() < 1.0
    steps = np.abs(np.diff(samples))
    assert abs(samples[0] - samples[-1]) <= steps.max()
    if name != "clap":
        assert samples.std() == pytest.approx(LOUDNESS, rel=0.01)


@given(st.integers(-2 * RATE, 4 * RATE), st.integers(1, 3000))
def test_a_sound_is_silent_before_its_begin_and_after_its_end(first: int, count: int) -> None:
    numbers = np.arange(first, first + count, dtype=float)
    emitted, _ = PlayingSound("ones", 0.0, 1.0, finer(np.ones(100, np.float32))).emitted(numbers)
    assert (emitted[(numbers < 0) | (numbers >= RATE)] == 0).all()
    assert emitted[(numbers > 300) & (numbers < RATE - 300)] == pytest.approx(1)
    assert np.abs(np.diff(emitted)).max(initial=0) < 0.01
