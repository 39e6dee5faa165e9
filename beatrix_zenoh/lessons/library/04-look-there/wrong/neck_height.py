# expects: pitch
"""The height of the eyes is forgotten, so the head looks too far up."""

import math


def bearing(x, y, z):
    """Look from the centre of the neck."""
    return math.degrees(math.atan2(y, x)), -math.degrees(math.atan2(z, math.hypot(x, y)))
