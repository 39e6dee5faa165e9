# expects: tiny
"""The function is right, but the program looks at the place where the person was yesterday."""

import math

from beatrix_zenoh import Robot


def bearing(x, y, z):
    """Right."""
    return math.degrees(math.atan2(y, x)), -math.degrees(math.atan2(z - 0.144, math.hypot(x, y)))


if __name__ == "__main__":
    with Robot() as robot:
        robot.make_ready()
        yaw, pitch = bearing(1.15, 0.0, 0.16)
        robot.look(yaw=yaw, pitch=pitch)
