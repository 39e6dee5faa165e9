# expects: radians
"""The right formula, but in radians."""

import math


def bearing(x, y, z):
    """Angles between -3.14 and 3.14."""
    return math.atan2(y, x), -math.atan2(z - 0.144, math.hypot(x, y))
