"""Draw the pictures of lesson 9 with their true bearings: `python tools/lesson_pictures.py`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import numpy as np

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.kinematics import Neck
from sim_node import gl
from sim_node.gl import GlPainter
from sim_node.model import eye_scene
from sim_node.painter import PosedModel
from sim_node.plant import Plant
from sim_node.renderer import picture

FOLDER: Final = Path(__file__).resolve().parents[1] / "beatrix_zenoh/lessons/library/09-follow-the-face/files"
WIDTH: Final = 160
HEIGHT: Final = 120
NOBODY: Final = (-1.5, 0.0, 0.1)
"""Behind the robot."""
SCENES: Final = (
    ((1.15, 0.3, 0.16), (0, 0)),
    ((1.15, 0.0, 0.16), (0, 0)),
    ((1.15, -0.3, 0.16), (0, 0)),
    ((0.8, 0.5, 0.2), (0, 0)),
    ((1.8, -0.9, 0.1), (0, 0)),
    (NOBODY, (0, 0)),
    ((1.1, 0.6, 0.1), (35, 0)),
    ((0.9, -0.6, 0.25), (-50, 5)),
    ((1.4, 0.2, 0.3), (25, -8)),
    ((2.0, 0.1, 0.2), (-10, 0)),
    (NOBODY, (40, 10)),
    ((0.7, -0.25, 0.1), (0, -5)),
)
"""Place of the person (m), and yaw and pitch of the head (deg)."""


def main() -> None:
    """Write all pictures, and bearings.toml."""
    backend = gl.backend()
    if backend is None:
        raise SystemExit("Drawing needs OpenGL: see docs/how-to/simulated-eyes.md.")
    painter = GlPainter(eye_scene(ROBOT), WIDTH, HEIGHT, name=backend, shadows=False, samples=0)
    posed, plant, neck = PosedModel(eye_scene(ROBOT).compile()), Plant(), Neck()
    FOLDER.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Bearing (deg, left is positive) of the person in each picture, written by tools/lesson_pictures.py."
    ]
    for number, (place, (yaw, pitch)) in enumerate(SCENES, start=1):
        plant.place(neck.inverse(math.radians(yaw), math.radians(pitch), 0.0))
        painter.pose(plant.posture(), place)
        (FOLDER / f"{number:02d}.jpg").write_bytes(picture(painter, "left"))
        posed.pose(plant.posture(), place)
        camera = posed.model.camera("eye_left").id
        seen = posed.data.cam_xmat[camera].reshape(3, 3).T @ (
            np.array(place) - posed.data.cam_xpos[camera]
        )  # x to the right, -z into the picture
        bearing = math.degrees(math.atan2(-seen[0], -seen[2]))
        lines.append(f"{number:02d} = " + ('"nobody"' if place == NOBODY else f"{bearing:.2f}"))
    (FOLDER / "bearings.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    painter.close()


if __name__ == "__main__":
    main()
