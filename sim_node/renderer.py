"""The process that draws the pictures of the eyes and of the outside view, and the class with which a node uses it.

`python -m sim_node.renderer ROBOT BACKEND` replies to each request with a JPEG picture for each of its views.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import simplejpeg

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import RobotData
from sim_node.gl import GlPainter
from sim_node.model import eye_scene
from sim_node.painter import SceneState
from sim_node.piped_process import OPENING_S, READY, PipedProcess, begin, reply, requests

WIDTH: Final = 640
HEIGHT: Final = 480
QUALITY: Final = 80
"""Quality of the JPEG pictures, percent."""
PICTURE_S: Final = 5.0
"""Longest wait for a picture after the first: a hundred times what a slow computer needs."""


class Renderer(PipedProcess):
    """Draws in a subprocess. One thread draws; any thread may call `close`."""

    def __init__(self, robot: RobotData, source: str) -> None:
        """Start the process; `source` is a backend of OpenGL. Raises OSError if it cannot be started."""
        super().__init__("sim_node.renderer", robot, source)
        self.source = source
        self._limit_s = OPENING_S  # OpenGL drivers compile shaders for the first picture

    def draw(self, state: SceneState, views: Sequence[str]) -> Iterator[tuple[str, bytes]]:
        """Yield each of `views` with its picture, a JPEG file; raises OSError if the process has ended or hangs."""
        self.ask(views, state)
        for view in views:
            yield view, self.read(self._limit_s)
            self._limit_s = PICTURE_S


def open_painter(robot: RobotData, source: str) -> GlPainter:
    """Create a painter of the views, for use in the calling thread."""
    return GlPainter(eye_scene(robot), WIDTH, HEIGHT, name=source, shadows=False, samples=0)


def picture(painter: GlPainter, view: str) -> bytes:
    """Draw the picture of one of `names.VIEWS`, and return it as a JPEG file."""
    image = painter.paint(f"eye_{view}" if view in names.EYES else view)
    jpeg: bytes = simplejpeg.encode_jpeg(
        np.ascontiguousarray(image), quality=QUALITY, colorspace="RGB", colorsubsampling="420"
    )
    return jpeg


def main(words: Sequence[str]) -> None:
    """Answer requests until standard input ends."""
    painter = open_painter(begin(words), words[1])
    reply(READY)
    for views, state in requests():
        painter.pose(state.posture, state.target)
        for view in views:
            reply(picture(painter, view))


if __name__ == "__main__":
    main(sys.argv[1:])
    os._exit(0)  # OpenGL drivers may crash while the interpreter exits
