"""Make docs/images/eyes.png: the robot face to face with a person, and what both eyes see. Needs OpenGL.

Usage: .venv/bin/python tools/eye_picture.py [FILE]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Final

from PIL import Image

from beatrix_zenoh.motion.kinematics import Neck
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.model import scene_spec
from sim_node.plant import Plant
from sim_node.visuals import add_camera

FILE: Final = Path(__file__).resolve().parents[1] / "docs/images/eyes.png"
WIDTH: Final = 960
"""Width of the whole picture (px)."""
ROOM_HEIGHT: Final = 440
GAP: Final = 4
"""White line between two pictures (px)."""
ROOM: Final = "room view"
BESIDE: Final = ((0.10, 1.38, 0.44), (0.50, 0.0, 0.10), 48.0)
"""Camera that sees robot and person from the side: its place, the point it looks at (m), vertical angle of view (deg)."""
HEAD_DEG: Final = (-4.0, 2.0, 0.0)
"""Yaw, pitch and roll of the head."""
PERSON: Final = (1.15, 0.0, 0.16)
"""The middle between the person's eyes (m)."""


def painted(cameras: tuple[str, ...], width: int, height: int) -> list[Image.Image]:
    """Draw the scene from several cameras, in twice the size, and shrink the pictures, which smooths their edges."""
    spec = scene_spec()
    add_camera(spec.worldbody, ROOM, *BESIDE)
    plant = Plant()
    plant.place(Neck().inverse(*map(math.radians, HEAD_DEG)))
    painter = GlPainter(spec, 2 * width, 2 * height, name=gl.backend() or "egl", shadows=True, samples=4)
    try:
        painter.pose(plant.posture(), PERSON)
        return [Image.fromarray(painter.paint(camera)).reduce(2) for camera in cameras]
    finally:
        painter.close()


def main() -> None:
    """Draw the pictures, and write them as one file."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    width = (WIDTH - GAP) // 2
    height = width * 3 // 4
    whole = Image.new("RGB", (WIDTH, ROOM_HEIGHT + GAP + height), "white")
    (room,) = painted((ROOM,), WIDTH, ROOM_HEIGHT)
    whole.paste(room, (0, 0))
    for index, eye in enumerate(painted(("eye_left", "eye_right"), width, height)):
        whole.paste(eye, (index * (width + GAP), ROOM_HEIGHT + GAP))
    whole.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=5, dither=Image.Dither.NONE).save(
        path, optimize=True
    )
    print(path, path.stat().st_size, "bytes")


if __name__ == "__main__":
    main()
