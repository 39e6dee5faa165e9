# expects: slow
"""Lesson 8, fifty times a second: let the head follow a sine, and measure how well it does."""

# %% The functions that `beatrix lesson check 8` calls
import math
import time

import numpy as np

from beatrix_zenoh import Robot

SIZE = 10.0  # deg, from the middle to one side


def alias(frequency, rate):
    """Return the lowest frequency (Hz) that has the same samples as `frequency` (Hz), at `rate` samples a second."""
    return abs(frequency - rate * round(frequency / rate))


def response(t, asked, measured, frequency):
    """Return gain and lag (s) of the sine `measured` compared with the sine `asked`; both have this frequency (Hz).

    t (s), asked (deg) and measured (deg) are lists of the same length.
    """
    (size_asked, phase_asked), (size, phase) = fit(t, asked, frequency), fit(t, measured, frequency)
    behind = (phase_asked - phase) % (2 * math.pi)
    return size / size_asked, behind / (2 * math.pi * frequency)


def fit(t, values, frequency):
    """Return size and phase (rad) of the sine of this frequency (Hz) that fits the values best."""
    angle = 2 * math.pi * frequency * np.asarray(t)
    columns = np.column_stack((np.sin(angle), np.cos(angle), np.ones_like(angle)))
    (sine, cosine, _), *_ = np.linalg.lstsq(columns, np.asarray(values), rcond=None)
    return math.hypot(sine, cosine), math.atan2(cosine, sine)


# %% The experiment
def follow_sine(robot, frequency, seconds):
    """Let the head follow a sine; return times (s), asked yaw (deg) and measured yaw (deg)."""
    with robot.stream() as stream:
        begin = time.monotonic()
        while time.monotonic() < begin + seconds:
            angle = 2 * math.pi * frequency * (time.monotonic() - begin)
            robot.look(yaw=SIZE * math.sin(angle))
            time.sleep(0.5)
        readings = stream.take()
    t = np.array([reading.t - begin for reading in readings])  # the robot's clock: the same on one computer
    measured = np.array([reading.head.yaw for reading in readings])
    return t, SIZE * np.sin(2 * math.pi * frequency * t), measured


if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        for frequency, seconds in ((0.25, 11), (2.0, 5)):
            t, asked, measured = follow_sine(robot, frequency, seconds)
            robot.home()
            time.sleep(1.0)  # rest, so that the two sines are apart
            settled = t > 2.0
            gain, lag = response(t[settled], asked[settled], measured[settled], frequency)
            print(f"{frequency} Hz: gain {gain:.2f}, lag {1000 * lag:.0f} ms, {len(t) / seconds:.1f} positions a second")
