"""Check of lesson 8."""

from __future__ import annotations

import numpy as np

from beatrix_zenoh.lessons.attempt import Attempt, Unmet
from beatrix_zenoh.lessons.measures import Curve
from beatrix_zenoh.lessons.picture import Panel

ALIASES = (
    (3, 50, 3),
    (49, 50, 1),
    (26, 50, 24),
    (50, 50, 0),
    (75.5, 50, 24.5),
    (120, 50, 20),
    (9, 10, 1),
    (7, 4, 1),
)
"""Frequency and rate (Hz), and the lowest frequency with the same samples (Hz)."""
RESPONSES = ((1.0, 0.54, 0.30), (0.25, 0.98, 0.07), (2.0, 0.18, 0.24), (2.0, 0.18, 0.45))
"""Frequency (Hz), gain and lag (s) of made-up measurements."""
SIZE = 10.0
TURN = 2 * np.pi
MANY = 20
"""A program that has sent so many targets, and has not ended, waits for its motions."""


def check(attempt: Attempt) -> None:
    """Require both functions, and a head that follows the slow sine and not the fast one."""
    for frequency, rate, lowest in ALIASES:
        found = attempt.call("alias", frequency, rate)
        attempt.require(
            "alias", abs(found - lowest) < 0.01, frequency=frequency, rate=rate, found=found, lowest=lowest
        )
    for frequency, gain, lag in RESPONSES:
        t, asked, measured = measurement(frequency, gain, lag)
        found_gain, found_lag = attempt.call_array("response", t, asked, measured, frequency, shape=(2,))
        attempt.require(
            "gain", abs(found_gain / gain - 1) < 0.03, frequency=frequency, found=found_gain, gain=gain
        )
        off = (found_lag - lag + 0.5 / frequency) % (1 / frequency) - 0.5 / frequency
        ahead = (found_lag + lag + 0.5 / frequency) % (1 / frequency) - 0.5 / frequency
        attempt.require("ahead", abs(off) < 0.02 or abs(ahead) > 0.02, found=1000 * found_lag, lag=1000 * lag)
        attempt.require("lag", abs(off) < 0.02, frequency=frequency, found=1000 * found_lag, lag=1000 * lag)
    attempt.panels = ()
    attempt.draw = lambda robots: [
        Panel("yaw (°)", one.t, one.yaw, zones=((SIZE - 0.5, SIZE + 0.5), (-SIZE - 0.5, 0.5 - SIZE)))
        for one in robots.values()
    ]
    try:
        seen = attempt.observe()
    except Unmet as unmet:
        waits = unmet.figure == "ends" and int(str(unmet.values["count"])) >= MANY
        attempt.require("waits", not waits, **unmet.values)
        raise
    slow, fast = size(seen.t, seen.yaw, 0.25, 8.0), size(seen.t, seen.yaw, 2.0, 2.5)
    attempt.require("far", slow / SIZE < 1.05, found=slow)
    once = size(seen.t, seen.yaw, 0.25, 4.0)
    attempt.require("short", slow / SIZE > 0.95 or once / SIZE < 0.95, found=slow)
    attempt.require("slow", slow / SIZE > 0.95, found=slow, gain=slow / SIZE)
    attempt.require("fast", 0.10 < fast / SIZE < 0.25, found=fast, gain=fast / SIZE)


def measurement(frequency: float, gain: float, lag: float) -> tuple[Curve, Curve, Curve]:
    """Return times (s), asked and measured yaw (deg) as of a robot: 50 Hz, noise, one gap, not from 0."""
    random = np.random.default_rng(8)
    t = np.delete(2.2 + np.arange(430) / 50 + random.normal(0, 0.0005, 430), slice(100, 104))
    angle = 2 * np.pi * frequency
    noise = random.normal(0, 0.03, len(t))
    return t, SIZE * np.sin(angle * t), 0.2 + gain * SIZE * np.sin(angle * (t - lag)) + noise


def size(t: Curve, values: Curve, frequency: float, seconds: float) -> float:
    """Return the size of the sine of this frequency (Hz) in the stretch of this length (s) that looks most like it."""
    best, found = 0.0, 0.0
    for begin in np.arange(t[0], max(t[0], t[-1] - seconds) + 0.1, 0.25):
        inside = (t >= begin) & (t < begin + seconds)
        part, angle = values[inside], 2 * np.pi * frequency * t[inside]
        if len(part) < 20 or np.std(part) < 0.1:
            continue
        columns = np.column_stack((np.sin(angle), np.cos(angle), np.ones_like(angle)))
        factors, *_ = np.linalg.lstsq(columns, part, rcond=None)
        alike = 1 - float(np.var(part - columns @ factors) / np.var(part))
        if alike > best:
            best, found = alike, float(np.hypot(factors[0], factors[1]))
    return found
