"""A picture of the simulated robot, with whatever the machine can draw with."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Final

import numpy as np

from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh.drive import Arms
from sim_node import gl
from sim_node.gl import GlPainter, Image
from sim_node.plant import Plant
from sim_node.rays import RayPainter

CAMERA: Final = "observer"
_SAMPLES: Final = 4
_OVERSAMPLING: Final = 2
"""Softens what samples of a pixel do not: edges of shadows, and edges cast by rays."""


def picture(
    arms: Arms, width: int = 1280, height: int = 960, robot: RobotData = ROBOT, camera: str = CAMERA
) -> Image:
    """The robot with its arms at these angles (rad); raises BeatrixError if no head fits them."""
    plant = Plant(robot)
    plant.place(arms)
    size = _OVERSAMPLING * width, _OVERSAMPLING * height
    name = gl.backend()
    if name is None:
        return _shrunk(RayPainter(robot, *size).paint(plant.posture(), camera))
    painter = GlPainter(robot, *size, name=name, shadows=True, samples=_SAMPLES)
    try:
        return _shrunk(painter.paint(plant.posture(), camera))
    finally:
        painter.close()


def write_picture(path: Path, arms: Arms, width: int = 1280, height: int = 960) -> None:
    """Write a picture as PNG file; raises OSError, or BeatrixError as `picture`."""
    path.write_bytes(png(picture(arms, width, height)))


def png(image: Image) -> bytes:
    """An image as PNG file: 8 bits, RGB, rows unfiltered (ISO/IEC 15948)."""
    height, width, _ = image.shape
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 1:] = image.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, body) for kind, body in parts)


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _shrunk(image: Image) -> Image:
    """Mean of blocks of pixels: soft edges."""
    height, width, _ = image.shape
    n = _OVERSAMPLING
    blocks = image.reshape(height // n, n, width // n, n, 3)
    mean: Image = blocks.mean(axis=(1, 3)).astype(np.uint8)
    return mean
