"""The colours of arms and head axes in every picture: models, plots, viewer and window.

All are readable on white and on black, and the three of one plot are distinguishable with colour blindness; a test
computes both.
"""

from __future__ import annotations

from typing import Final

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import COLOURS

Colour = tuple[int, int, int]
"""red, green, blue: 0 to 255"""

ARMS: Final[dict[str, Colour]] = {name: getattr(COLOURS, name) for name in names.ARMS}
AXES: Final[dict[str, Colour]] = {name: getattr(COLOURS, name) for name in ("yaw", "pitch", "roll")}
ALL: Final[dict[str, Colour]] = ARMS | AXES
STYLES: Final = "hardware wide, simulation thin and pale"
"""How plots of both robots draw the curves of one arm or axis (`pale`), as their titles say."""

_PALE: Final = 0.65
"""Share of white."""


def hexadecimal(colour: Colour) -> str:
    """Return a colour as `#rrggbb`."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def pale(colour: Colour) -> Colour:
    """Return the same hue mixed with white, for a thin line on a wide one of the colour itself."""
    red, green, blue = (round(part + (255 - part) * _PALE) for part in colour)
    return red, green, blue
