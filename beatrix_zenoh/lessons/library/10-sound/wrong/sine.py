# expects: sine
"""Lesson 10, turn to a sound: find the delay between both ears, and turn the head to where the sound comes from."""

# %% The function that `beatrix lesson check 10` calls
import math

import numpy as np

from beatrix_zenoh import Robot

RATE = 48000  # samples per second
SPEED = 343.0  # m/s, of sound
EARS = 0.15  # m, from ear to ear
FINE = 16  # points per sample at which the correlation is computed


def direction(left, right):
    """Return the angle (deg, left is plus) from straight ahead to the source of a sound.

    `left` and `right` are what both ears heard at the same time: samples from -1 to 1.
    """
    length = 2 * len(
        left
    )  # zeros at the end, so that the end of one ear does not meet the start of the other
    cross = np.fft.rfft(left, length) * np.conj(np.fft.rfft(right, length))
    cross /= (
        np.abs(cross) + 1e-12
    )  # PHAT: keep the phase; a loud tone counts no more than any other frequency
    correlation = np.fft.irfft(cross, length * FINE)
    most = math.ceil(EARS / SPEED * RATE * FINE)  # a sound from the side has the largest delay
    possible = np.concatenate([correlation[-most:], correlation[: most + 1]])
    later_left = (np.argmax(possible) - most) / FINE / RATE  # s by which the left ear hears later
    sine = -later_left * SPEED / EARS
    return math.degrees(math.sin(sine))


# %% The robot: wait for a sound, and turn to it
def turn(robot):
    """Listen until a sound is louder than the noise of the ears, and turn the head to it once."""
    with robot.microphones() as ears:
        sound = ears.listen(0.1)
        while max(sound.level) < -45:
            sound = ears.listen(0.1)
        sound = ears.listen(0.3)
    robot.look(yaw=direction(sound.left, sound.right))


if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        turn(robot)
