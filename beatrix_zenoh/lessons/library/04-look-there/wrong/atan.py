# expects: yaw
"""atan of a quotient: a place behind the robot is taken for one in front of it."""

import math


def bearing(x, y, z):
    """Right only for x > 0."""
    yaw = math.degrees(math.atan(y / x))
    return yaw, -math.degrees(math.atan2(z - 0.144, math.hypot(x, y)))
