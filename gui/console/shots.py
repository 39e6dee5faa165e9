"""Photos and films of robots: `python -m gui.console.shots NAME` reads a Shot as JSON, and writes NAME with an ending.

A process of its own, because drawing takes a processor core, and Python runs one thread of a process at a time.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from PIL import Image

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.portrait import BACKGROUND, PoseRenderer, write
from beatrix_zenoh.body.scene import Viewpoint
from beatrix_zenoh.files import replace_when_complete
from beatrix_zenoh.shutdown import signals_interrupt

RATE: Final = 25
"""Poses of a film in a second; a GIF shows each second one, because its times are hundredths of a second."""
PHOTO, FILM, GIF = (1280, 960), (640, 480), (480, 360)
"""Sizes of one robot (px)."""
BAND: Final = 1 / 12
"""Height of the caption, as a share of that of a robot."""
FACE: Final = Viewpoint(azimuth=0.0, elevation=8.0, zoom=1.12, height=0.056)
"""From the front, with the whole head in every pose."""
COLOURS: Final = 128
Pose = tuple[float, float, float, float, float, float]
"""Short, middle and long arm, yaw, pitch and roll of the head (deg)."""


class Shot(msgspec.Struct, frozen=True):
    """What a photo or film shows."""

    caption: str
    date: str
    titles: tuple[str, ...]
    """over each robot; empty: none"""
    poses: list[tuple[Pose, ...]]
    """of each robot, at RATE; one moment is a photo"""


def pictures(shot: Shot, size: tuple[int, int], step: int = 1) -> Iterator[Image.Image]:
    """Yield the robots beside each other, with the caption below, at each `step`-th moment."""
    (width, height), count = size, len(shot.poses[0])
    band = round(height * BAND) // 2 * 2  # H.264 needs even sizes
    small, edge = band * 9 // 20, band // 2
    robots = [PoseRenderer(Figure(), width, height, FACE) for _ in range(count)]
    image = Image.new("RGB", (width * count, height + band), BACKGROUND)
    write(image, (edge, height + edge), shot.caption, anchor="lm", size=small)
    write(image, (width * count - edge, height + edge), shot.date, anchor="rm", size=small)
    for moment in shot.poses[::step]:
        for column, (robot, pose, title) in enumerate(zip(robots, moment, shot.titles, strict=True)):
            picture = robot.picture(np.array(pose[:3]), np.array(pose[3:]))
            image.paste(Image.fromarray(picture), (column * width, 0))
            write(image, (column * width + edge, edge), title, size=small)
        yield image


def save_gif(path: Path, shot: Shot) -> None:
    """Write a film that repeats; all its pictures have the colours of the first one."""
    first, *rest = (image.copy() for image in pictures(shot, GIF, 2))
    palette = first.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=2)
    images = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in (first, *rest))
    next(images).save(path, save_all=True, append_images=images, duration=2000 // RATE, loop=0)


def written(name: Path, shot: Shot) -> Path:
    """Write a photo (PNG), or a film (MP4 if the library for films is installed, otherwise GIF); return its path."""
    save: Callable[[Path], object] = lambda path: next(pictures(shot, PHOTO)).save(path)  # noqa: E731
    ending = ".png"
    if len(shot.poses) > 1:
        save, ending = lambda path: save_gif(path, shot), ".gif"
        with contextlib.suppress(ImportError):
            from beatrix_zenoh.body.video import FilmFrame, write_video  # noqa: PLC0415

            moments = enumerate(pictures(shot, FILM))
            frames = (FilmFrame(round(k * 1e9 / RATE), np.asarray(image)) for k, image in moments)
            save, ending = lambda path: write_video(path, frames), ".mp4"
    path = name.with_name(name.name + ending)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replace_when_complete(path) as unfinished:
        save(unfinished)
    return path


if __name__ == "__main__":
    if hasattr(os, "nice"):
        os.nice(10)  # the window goes first
    with signals_interrupt():  # so that SIGTERM deletes an incomplete file
        print(written(Path(sys.argv[1]), msgspec.json.decode(sys.stdin.buffer.read(), type=Shot)))  # noqa: T201
