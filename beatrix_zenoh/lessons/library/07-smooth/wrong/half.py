# expects: goal
"""Lesson 7: a smooth turn, as a function of time."""

import time

from beatrix_zenoh import Robot

# %% The turn
WAY = 30  # degrees
TOP = 30  # highest speed, degrees per second
ACCELERATION = 180  # degrees per second, each second


# %% Your function
def angle(t):
    """The angle (degrees) of the head, t seconds after the start: 0 before it, WAY after the end."""
    rise = TOP / ACCELERATION  # time until the head has its highest speed
    end = WAY / TOP
    if t <= 0:
        return 0
    if t < rise:
        return ACCELERATION * t**2 / 2
    if t < end - rise:
        return TOP * (t - rise / 2)
    if t < end:
        return WAY - ACCELERATION * (end - t) ** 2 / 2
    return TOP * (t - rise / 2) if t < end else TOP * (end - rise / 2)


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
