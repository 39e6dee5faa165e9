"""Lesson 10, turn to a sound: find the delay between both ears, and turn the head to where the sound comes from."""

# %% The function that `beatrix lesson check 10` calls
import math

import numpy as np

from beatrix_zenoh import Robot

RATE = 48000  # samples per second
SPEED = 343.0  # m/s, of sound
EARS = 0.15  # m, from ear to ear


def direction(left, right):
    """Return the angle (deg, left is plus) from straight ahead to the source of a sound.

    `left` and `right` are what both ears heard at the same time: samples from -1 to 1.
    """
    correlation = np.correlate(left, right, "full")
    later_left = (np.argmax(correlation) - (len(left) - 1)) / RATE  # s by which the left ear hears later
    sine = -later_left * SPEED / EARS
    return math.degrees(math.asin(max(-1.0, min(1.0, sine))))


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
