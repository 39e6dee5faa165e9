"""Portraits of a robot: the picture of a pose, drawn without a screen, and text in it. Needs Pillow."""

from __future__ import annotations

import contextlib
import math
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.scene import HeadDrawing, Screen, Viewpoint, draw
from beatrix_zenoh.body.surface import Floats
from beatrix_zenoh.motion.rotation import rotation_of

Pixels = npt.NDArray[np.uint8]
"""(height, width, 3) red, green, blue"""

BACKGROUND: Final = (236, 239, 243)
VIEW: Final = Viewpoint(azimuth=-31.0, elevation=13.0, zoom=0.84, height=-0.001)
"""About as in the recording's side-by-side view, with the whole robot in every pose."""
SMOOTHING: Final = 2
"""Pixels are drawn this much smaller in both directions, and averaged."""
INK: Final = (45, 52, 60)
FONTS: Final = ("DejaVuSans.ttf", "LiberationSans-Regular.ttf", "arial.ttf", "Arial.ttf")
"""Linux, Windows, macOS."""


class PoseRenderer:
    """Pictures of one robot in the poses that are asked for."""

    def __init__(self, figure: Figure, width: int, height: int, view: Viewpoint = VIEW) -> None:
        """Prepare pictures of this size (pixels)."""
        self._figure = figure
        self.screen = Screen(view, width * SMOOTHING, height * SMOOTHING)
        self._last: tuple[tuple[float, ...], Pixels] | None = None

    def picture(self, arms_deg: Floats, head_deg: Floats) -> Pixels:
        """Return the picture of a pose: angles of the arms, and yaw, pitch and roll of the head (deg)."""
        pose = (*arms_deg.tolist(), *head_deg.tolist())
        if self._last is None or max(abs(a - b) for a, b in zip(pose, self._last[0], strict=True)) > 0.02:
            short, middle, long, *head = (math.radians(angle) for angle in pose)
            turns = self._figure.orientations((short, middle, long), rotation_of(*head))
            self._last = pose, painted(draw(meshes(self._figure), turns, self.screen), self.screen)
        return self._last[1]


def painted(drawing: HeadDrawing, screen: Screen) -> Pixels:
    """Return a picture of the faces, the furthest first, with a SMOOTHING-th of the screen's pixels in both directions."""
    image = Image.new("RGB", (round(screen.width), round(screen.height)), BACKGROUND)
    painter = ImageDraw.Draw(image)
    for corners, colour in zip(
        drawing.corners.reshape(-1, 8).tolist(), drawing.colours.tolist(), strict=True
    ):
        painter.polygon(corners, fill=f"#{colour:06x}")
    return np.asarray(image.reduce(SMOOTHING))


def write(image: Image.Image, at: tuple[int, int], text: str, *, anchor: str = "la", size: int = 20) -> None:
    """Write text of a size (pixels) into a picture; the anchor is Pillow's."""
    ImageDraw.Draw(image).text(at, text, fill=INK, font=_font(size), anchor=anchor)


@cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Return a font of the system: Pillow's own one has no umlauts."""
    for name in FONTS:
        with contextlib.suppress(OSError):
            return ImageFont.truetype(name, size)
    return ImageFont.load_default(size)
