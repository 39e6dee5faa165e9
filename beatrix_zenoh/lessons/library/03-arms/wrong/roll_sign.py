# expects: sign
"""Roll with the wrong sign."""


def rule(short, middle, long):
    """Roll to the left instead of to the right."""
    mean = (short + middle + long) / 3
    return mean, short - mean, 0.58 * (middle - long)


def arms_for_nod(pitch):
    """Right."""
    return pitch, -pitch / 2, -pitch / 2
