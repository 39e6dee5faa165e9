"""Nod at a clap: the head nods when its ears hear a clap. Copy this program, and change what you like.

python nod_at_a_clap.py           the simulation, in whose room the program claps
python nod_at_a_clap.py hw        the robot: its microphones listen to the room, so tell the people in it
python nod_at_a_clap.py hw sim    both; the ears are those of the first
"""

# %% What you may change
import sys

import numpy as np

from beatrix_zenoh import Robot

LISTEN = 0.3  # s: how long the ears listen before each decision
LOUDER = 15.0  # dB: by how much a clap is louder than the room before it
QUIET = -45.0  # dB: what is quieter is no clap
SHORT = 0.1  # s after which a clap is over; a voice lasts longer
NOD, SPEED = 15.0, 60.0  # deg down, and deg/s

PIECE = 0.01  # s: the sound is heard in pieces of this length


# %% What a clap is
def claps(sound, rate):
    """Return when (s) claps begin in a sound: an array with one row for each sample, one column for each ear."""
    length = round(PIECE * rate)
    pieces = sound[: len(sound) // length * length].reshape(-1, length, sound.shape[1])
    loud = 10 * np.log10(np.square(pieces).mean(axis=(1, 2)) + 1e-12)  # dB of each piece
    short, last = round(SHORT / PIECE), -100
    found = []
    for i in range(short, len(loud) - short):
        before = np.median(loud[i - short : i])
        after = loud[i + short]
        if (
            loud[i] > QUIET
            and loud[i] > before + LOUDER
            and loud[i] > after + LOUDER / 2
            and i - last > short
        ):
            last = i
            found.append(i * PIECE)
    return found


# %% The loop: listen, nod, wait until the head rests
def nod(robots):
    """Let the heads of all robots nod at each clap that the first one hears."""
    with robots[0].microphones() as ears:
        before = ears.listen(LISTEN)
        while True:
            now = ears.listen(LISTEN)
            heard = claps(np.concatenate([before.samples, now.samples]), now.rate)
            before = now  # a clap at the end is heard the next time, when what follows is known
            if not heard:
                continue
            print("A clap." if len(heard) == 1 else f"{len(heard)} claps.", flush=True)
            for pitch in (NOD, 0.0) * len(heard):
                for motion in [robot.look(pitch=pitch, speed=SPEED, wait=False) for robot in robots]:
                    motion.result()
            ears.take()  # what was heard while the head nodded: its motors are loud
            before = ears.listen(LISTEN)


if __name__ == "__main__":
    print("Listening.", flush=True)
    robots = [Robot(side=side) for side in sys.argv[1:] or ["sim"]]
    try:
        for robot in robots:
            if robot.side == "sim":  # you make the hardware ready yourself, when its head is upright
                robot.make_ready()
        if robots[0].side == "sim":
            robots[0].play_sound("clap", seconds=5)  # one clap a second
        nod(robots)
    except KeyboardInterrupt:
        for robot in robots:
            robot.stop()
    finally:
        for robot in robots:
            robot.close()
