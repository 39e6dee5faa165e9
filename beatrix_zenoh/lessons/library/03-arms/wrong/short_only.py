# expects: pitch
"""Pitch from the short arm alone, as the first line of the table suggests."""


def rule(short, middle, long):
    """The middle and the long arm do not pitch here, but they do on the robot."""
    return (short + middle + long) / 3, 0.67 * short, 0.58 * (long - middle)


def arms_for_nod(pitch):
    """Right."""
    return pitch, -pitch / 2, -pitch / 2
