"""Check of lesson 10."""

from __future__ import annotations

import math
import time

import numpy as np
import numpy.typing as npt

from beatrix_zenoh.lessons import slips
from beatrix_zenoh.lessons.attempt import Attempt, Stage, Unmet

RATE, SPEED_M_S, EARS_M = 48_000, 343.0, 0.15
HEARD_S = 0.2
SEED = 40
DIRECTIONS = (-45, -36, -27, -15, -6, 4, 12, 23, 33, 44)
"""Directions (deg) of the sounds of the function's check; left is plus."""
NEAR_DEG = 3.0
"""The solution is within 0.8 deg."""
SINE_DEG = 1.5
"""At the widest sound the sine is 7.8 deg off, and 3.3 deg from what a straight line gives."""
NOISE_HZ = (200.0, 8000.0)
HUM_HZ, HUM = 120.0, 8.4
"""A fan between both ears: the frequency and the amplitude of its tone, where the sound has the power 1."""
SOURCE = 35.0
"""Direction (deg) of the observed check's source, AWAY_M from the neck."""
AWAY_M, UP_M = 1.3, 0.15
READY_S, LIMIT_S, MISS_DEG = 15.0, 3.0, 5.0

Curve = npt.NDArray[np.float64]


def heard(direction: float, seed: int) -> tuple[Curve, Curve]:
    """Return what both ears hear of a noise from far away, with as strong a noise of their own (0 dB), and a fan."""
    random, length = np.random.default_rng(seed), round(HEARD_S * RATE)
    padded = length + 512
    hz = np.fft.rfftfreq(padded, 1 / RATE)
    spectrum = np.fft.rfft(random.standard_normal(padded)) * ((hz > NOISE_HZ[0]) & (hz < NOISE_HZ[1]))
    spectrum /= np.fft.irfft(spectrum, padded).std()
    late_s = EARS_M * math.sin(math.radians(direction)) / SPEED_M_S / 2
    t = np.arange(length) / RATE
    fan = HUM * sum(np.sin(math.tau * HUM_HZ * k * t + k) / k for k in (1, 2, 3))
    left, right = (
        0.02
        * (
            np.fft.irfft(spectrum * np.exp(-1j * math.tau * hz * shift), padded)[256 : 256 + length]
            + fan
            + random.standard_normal(length)
        )
        for shift in (-late_s, late_s)
    )
    return left, right


def check(attempt: Attempt) -> None:
    """Ask for ten directions, then play a sound beside the robot and look where its head turns."""
    found = [
        attempt.call("direction", *heard(direction, seed)) for seed, direction in enumerate(DIRECTIONS, SEED)
    ]
    pairs = list(zip(DIRECTIONS, found, strict=True))
    small = [abs(said - true) <= NEAR_DEG for true, said in pairs if abs(true) < 20]
    wide = [(true, said) for true, said in pairs if abs(true) >= 20]
    slips.numbers("direction", found, DIRECTIONS, NEAR_DEG)
    stuck = [true for true, said in wide if abs(said) < abs(true) / 4]
    attempt.require("fan", len(stuck) < 2, count=len(stuck))
    attempt.require(
        "sine", not all(abs(said - sine(true)) <= SINE_DEG for true, said in pairs), found=found[0]
    )
    for true, said in wide:
        near = abs(said - true) <= NEAR_DEG
        attempt.require("wide", near or not all(small), true=true, found=said)
    for true, said in pairs:
        attempt.require("direction", abs(said - true) <= NEAR_DEG, true=true, found=said)
    live(attempt)


def sine(direction: float) -> float:
    """Return what a program finds that takes the sine of the ratio in place of its arcsine (deg)."""
    return math.degrees(math.sin(math.sin(math.radians(direction))))


def live(attempt: Attempt) -> None:
    """Play a noise once the program listens; the head must be at its source soon."""
    played: list[float] = []

    def during(stage: Stage) -> None:
        began_s, robot = time.monotonic(), stage.robot()
        angle = math.radians(SOURCE)
        robot.play_sound("silence")
        robot.place_sound(AWAY_M * math.cos(angle), AWAY_M * math.sin(angle), UP_M)
        while not ((ears := robot.status().microphones) and ears.streaming):
            if time.monotonic() > began_s + READY_S:
                raise Unmet("listens", seconds=READY_S)
            time.sleep(0.05)
        robot.play_sound("noise", 20)
        played.append(time.monotonic() - began_s)

    seen = attempt.observe(during=during)
    late = seen.yaw[seen.t >= played[0] + LIMIT_S]
    last = float(late[0] if len(late) else seen.yaw[-1])
    attempt.require("arrives", abs(last - SOURCE) <= MISS_DEG, yaw=last, true=SOURCE)
