"""Turn to the sound: the head turns to what both ears hear. Copy this program, and change what you like.

python turn_to_the_sound.py           the simulation
python turn_to_the_sound.py hw        the robot: its microphones listen to the room, so tell the people in it
python turn_to_the_sound.py hw sim    both; the ears are those of the first
"""

# %% What you may change
import math
import sys

import numpy as np

from beatrix_zenoh import Robot

LISTEN = 0.4  # s: how long the ears listen before each turn
QUIET = -45.0  # dB: what is quieter is silence
LEAST = 4.0  # deg: the head does not turn for less
REACH = 75.0  # deg: the head turns no further
SPEED = 60.0  # deg/s

EARS = 0.15  # m from ear to ear
SOUND = 343.0  # m/s
FINE = 8  # a delay is found to an eighth of a sample


# %% Where a sound comes from
def direction(left, right, rate):
    """Return the angle (deg, left is plus) from straight ahead to the source of what both ears heard.

    The ear on the far side hears it later. The delay is where both ears are most alike: the peak of their correlation.
    Every frequency counts the same, however loud it is (GCC-PHAT), so that a hum does not hide the rest.
    """
    length = 2 * len(left)  # zeros behind the sound, so that its end does not meet its start
    both = np.fft.rfft(left, length) * np.conj(np.fft.rfft(right, length))
    alike = np.fft.irfft(both / (np.abs(both) + 1e-12), length * FINE)
    most = math.ceil(EARS / SOUND * rate * FINE)  # a sound from the side has the largest delay
    possible = np.concatenate([alike[-most:], alike[: most + 1]])
    late = (np.argmax(possible) - most) / FINE / rate  # s by which the left ear hears later
    return -math.degrees(math.asin(max(-1.0, min(1.0, late * SOUND / EARS))))


# %% The loop: listen at rest, turn, wait until the head rests
def turn(robots):
    """Turn the heads of all robots to what the first one hears."""
    with robots[0].microphones() as ears:
        while True:
            ears.take()  # what was heard while the head turned: its motors are loud
            sound = ears.listen(LISTEN)
            if max(sound.level) < QUIET:
                continue
            angle = direction(sound.left, sound.right, sound.rate)
            if abs(angle) < LEAST:
                continue
            yaw = max(-REACH, min(REACH, robots[0].positions().head.yaw + angle))
            print(f"A sound, {abs(angle):.0f} degrees to the {'left' if angle > 0 else 'right'}.", flush=True)
            for motion in [robot.look(yaw=yaw, speed=SPEED, wait=False) for robot in robots]:
                motion.result()


if __name__ == "__main__":
    print("Listening.", flush=True)
    robots = [Robot(side=side) for side in sys.argv[1:] or ["sim"]]
    try:
        for robot in robots:
            if robot.side == "sim":  # you make the hardware ready yourself, when its head is upright
                robot.make_ready()
        turn(robots)
    except KeyboardInterrupt:
        for robot in robots:
            robot.stop()
    finally:
        for robot in robots:
            robot.close()
