# expects: nod
"""The rule is right, but the nod turns the short arm only."""


def rule(short, middle, long):
    """Right."""
    mean = (short + middle + long) / 3
    return mean, short - mean, 0.58 * (long - middle)


def arms_for_nod(pitch):
    """Pitches by the right angle, and yaws by half of it."""
    return 1.5 * pitch, 0, 0
