"""Lesson 9, follow the face: find the magenta cap in a picture, and turn the head after it."""

# %% The functions that `beatrix lesson check 9` calls
import math
import time

import numpy as np
import simplejpeg

from beatrix_zenoh import Robot

VIEW = 60.0  # deg from the top to the bottom of a picture
FOUND = 20  # pixels of the cap; fewer are something else
GAIN = 2.0  # 1/s


def bearing(picture):
    """Return the angle (deg, left is plus) from the middle of a picture to the person, or None if nobody is there.

    A picture has rows, columns and three colours: red, green, blue from 0 to 255.
    """
    picture = np.asarray(picture).astype(int)
    height, width, _ = picture.shape
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    _, columns = np.nonzero((red > 100) & (green < 60) & (blue > 60) & (red > blue + 30))
    if len(columns) < FOUND:
        return None
    focus = height / 2 / math.tan(math.radians(VIEW / 2))  # distance of the picture from the eye, in pixels
    return math.degrees(math.atan((columns.mean() - width / 2) / focus))


def step(error, dt):
    """Return the speed (deg/s) at which the head should turn to the left.

    The person is `error` (deg) to the left of where the head looks; the last call was dt (s) ago.
    """
    return GAIN * error


# %% The robot: follow until Ctrl-C
def follow(robot):
    """Turn the head after the person, 25 times a second, with the newest picture."""
    target, person, last = 0.0, 0.0, time.monotonic()
    times, yaws = [0.0], [0.0]
    with robot.stream() as positions, robot.camera("left") as pictures:
        while True:
            time.sleep(0.04)
            for reading in positions.take():
                times, yaws = [*times[-200:], reading.t], [*yaws[-200:], reading.head.yaw]
            for image in pictures.take():
                seen = bearing(simplejpeg.decode_jpeg(image.jpeg))
                if seen is not None:  # where the head looked when the picture was taken, and further by what is seen
                    person = np.interp(image.t_mono_ns / 1e9, times, yaws) + seen
            now = time.monotonic()
            target += step(person - target, now - last) * (now - last)
            last = now
            robot.look(yaw=target, wait=False)


if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        try:
            follow(robot)
        except KeyboardInterrupt:
            robot.stop()
