"""Lesson 7: a smooth turn, as a function of time."""

import math
import time

from beatrix_zenoh import Robot

# %% The turn
WAY = 30  # degrees
TOP = 30  # highest speed, degrees per second
ACCELERATION = 180  # degrees per second, each second


# %% Your function
def angle(t):
    """The angle (degrees) of the head, t seconds after the start: 0 before it, WAY after the end."""
    steps = math.floor(t / 0.2)  # a staircase: 5 degrees more every 0.2 s
    return max(0, min(WAY, 5 * steps))


# %% Send 50 targets a second
def main():
    robot = Robot()
    robot.make_ready()
    began = time.monotonic()
    while (t := time.monotonic() - began) < 1.5:
        robot.look(yaw=angle(t), speed=40, wait=False)
        time.sleep(0.02)
    robot.look(yaw=WAY)
    robot.home()


if __name__ == "__main__":
    main()
