# expects: yaw
"""The sum of the arms instead of their mean."""


def rule(short, middle, long):
    """Yaw three times too large."""
    yaw = short + middle + long
    return yaw, short - yaw / 3, (long - middle) / 1.73


def arms_for_nod(pitch):
    """Right."""
    return pitch, -pitch / 2, -pitch / 2
