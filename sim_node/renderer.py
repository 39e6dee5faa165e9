"""The process that draws the pictures of the eyes and of the outside view, and the class with which a node uses it.

`python -m sim_node.renderer ROBOT BACKEND` prints `ready`, then reads requests. A request contains the views to draw, a
posture and the person's place. For each of these views the process writes the length of a JPEG picture, and the
picture.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import struct
import sys
from collections.abc import Iterator, Sequence
from typing import Final

import msgspec
import numpy as np
import simplejpeg

from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.robot import RobotData
from sim_node.gl import GlPainter
from sim_node.model import eye_scene
from sim_node.painter import SceneState
from sim_node.piped_process import NICE, OPENING_S, READY, PipedProcess

WIDTH: Final = 640
HEIGHT: Final = 480
QUALITY: Final = 80
"""Quality of the JPEG pictures, percent."""
PICTURE_S: Final = 5.0
"""Longest wait for a picture after the first: a hundred times what a slow computer needs."""

_POSTURE: Final = 10
_REQUEST: Final = struct.Struct(f"<{len(names.VIEWS)}?{_POSTURE + 3}d")
_LENGTH: Final = struct.Struct("<I")


class Renderer:
    """Draws in a subprocess. One thread draws; any thread may call `close`."""

    def __init__(self, robot: RobotData, source: str) -> None:
        """Start the process; `source` is a backend of OpenGL. Raises OSError if it cannot be started."""
        self.source = source
        self._limit_s = OPENING_S  # OpenGL drivers compile shaders for the first picture
        self._process = PipedProcess("sim_node.renderer", robot, source)

    def open(self) -> None:
        """Wait until the process is ready; raises OSError if it cannot draw on this computer, or is closed."""
        if not self._process.ready():
            self.close()
            raise OSError(f"{self.source} cannot draw on this computer")

    def draw(self, state: SceneState, views: Sequence[str]) -> Iterator[tuple[str, bytes]]:
        """Yield each of `views` with its picture, a JPEG file; raises OSError if the process has ended or hangs."""
        wanted = (view in views for view in names.VIEWS)
        self._process.write(_REQUEST.pack(*wanted, *state.posture, *state.target))
        for view in names.VIEWS:
            if view in views:
                (length,) = _LENGTH.unpack(self._process.read(_LENGTH.size, self._limit_s))
                yield view, self._process.read(length, self._limit_s)
                self._limit_s = PICTURE_S

    def close(self) -> None:
        """End the process; may be called twice."""
        self._process.close()


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
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the node handles Ctrl-C and ends this process
    painter = open_painter(msgspec.json.decode(words[0], type=RobotData), words[1])
    requests, pictures = sys.stdin.buffer, sys.stdout.buffer
    pictures.write(READY)
    pictures.flush()
    lowered = False
    while len(request := requests.read(_REQUEST.size)) == _REQUEST.size:
        fields = _REQUEST.unpack(request)
        wanted, numbers = fields[: len(names.VIEWS)], fields[len(names.VIEWS) :]
        x, y, z = numbers[_POSTURE:]
        painter.pose(np.array(numbers[:_POSTURE]), (x, y, z))
        for view in itertools.compress(names.VIEWS, wanted):
            jpeg = picture(painter, view)
            pictures.write(_LENGTH.pack(len(jpeg)) + jpeg)
            pictures.flush()
        if not lowered:  # only after the first picture, because a client waits for it
            lowered = True
            with contextlib.suppress(AttributeError, OSError):
                os.nice(NICE)


if __name__ == "__main__":
    main(sys.argv[1:])
    os._exit(0)  # OpenGL drivers may crash while the interpreter exits
