"""Pictures of the simulated robot for tools and tests, drawn with OpenGL."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Final

import mujoco
import numpy as np
from studio import CAMERA, studio

from beatrix_zenoh.motion.gear import Arms
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.painter import Image
from sim_node.plant import Plant
from sim_node.viewer import MECHANISM, SKIN_OPACITY, add_mechanism
from sim_node.visuals import MATERIALS, VISUAL

_SAMPLES: Final = 4
_OVERSAMPLING: Final = 2
"""Pictures are drawn larger by this factor, which smooths all edges."""


def picture(arms: Arms, width: int, height: int, spec: mujoco.MjSpec | None = None) -> Image:
    """Draw the robot, or another model of it, with these arm angles (rad).

    Raises BeatrixError if the head cannot be assembled with them.
    """
    plant = Plant()
    plant.place(arms)
    painter = _painter(spec or studio(), _OVERSAMPLING * width, _OVERSAMPLING * height)
    try:
        painter.pose(plant.posture())
        return _shrunk(painter.paint(CAMERA))
    finally:
        painter.close()


def _painter(spec: mujoco.MjSpec, width: int, height: int) -> GlPainter:
    name = gl.backend()
    if name is None:
        raise OSError("this computer has no OpenGL")
    return GlPainter(spec, width, height, name=name, shadows=True, samples=_SAMPLES)


def png(image: Image) -> bytes:
    """Encode an image as a PNG file: 8 bits, RGB, rows unfiltered (ISO/IEC 15948)."""
    height, width, _ = image.shape
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 1:] = image.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, body) for kind, body in parts)


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _shrunk(image: Image) -> Image:
    """Reduce an image by _OVERSAMPLING: each pixel becomes the mean of a block of pixels."""
    height, width, _ = image.shape
    n = _OVERSAMPLING
    blocks = image.reshape(height // n, n, width // n, n, 3)
    mean: Image = blocks.mean(axis=(1, 3)).astype(np.uint8)
    return mean


def write_mechanism(path: Path) -> None:
    """Write a picture of the mechanism inside the translucent robot, as a PNG file; raises OSError."""
    spec = studio()
    for name in MATERIALS.values():
        spec.material(name).rgba[3] = SKIN_OPACITY
    add_mechanism(spec)
    for geom in spec.geoms:
        if geom.group == MECHANISM:
            geom.group = VISUAL
    path.write_bytes(png(picture((0.0, 0.0, 0.0), 800, 720, spec)))
