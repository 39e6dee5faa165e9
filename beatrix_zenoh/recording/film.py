"""The frames of films: the pictures of an eye, or simulation and hardware beside each other."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.portrait import BACKGROUND, PoseRenderer, write
from beatrix_zenoh.body.video import FilmFrame
from beatrix_zenoh.contract.names import ARMS, SIDE_TITLES, SIDES
from beatrix_zenoh.recording.export import Block, Table
from beatrix_zenoh.recording.samples import EyePicture
from beatrix_zenoh.recording.series import HEAD

Array = npt.NDArray[np.float64]

STEPS: Final = 2
"""Steps of the grid of 20 ms between two frames: 25 frames a second."""
PANEL: Final = (640, 480)
"""Size of the drawing of one robot (pixels)."""


def eye_frames(pictures: Sequence[EyePicture]) -> Iterator[FilmFrame]:
    """Yield the pictures of an eye in the size of the first one; leaves out damaged pictures and repeated times."""
    size: tuple[int, int] | None = None
    last_ns = -1
    for picture in pictures:
        image = decoded(picture.jpeg)
        if image is None or picture.time_ns <= last_ns:
            continue
        last_ns = picture.time_ns
        size = size or (image.width // 2 * 2, image.height // 2 * 2)  # H.264 halves the resolution of colours
        yield FilmFrame(picture.time_ns, np.asarray(image if image.size == size else image.resize(size)))


def side_by_side(table: Table, name: str) -> Iterator[FilmFrame]:
    """Yield the drawings of simulation and hardware of a robot.

    The robots have the geometry of the project. A robot without samples at a time is not drawn.
    """
    sides = [side for side in SIDES if (name, side) in table.robots]
    drawings = {side: PoseRenderer(Figure(), *PANEL) for side in sides}
    canvas = Image.new("RGB", (PANEL[0] * len(sides), PANEL[1]))
    for time_ns, time_s, block, row in frame_rows(table):
        for column, side in enumerate(sides):
            drawn = panel(drawings[side], block, row, f"{name}_{side}_", f"{name}, {SIDE_TITLES[side]}")
            canvas.paste(drawn, (column * PANEL[0], 0))
        write(canvas, (canvas.width - 16, 12), f"{time_s:.2f} s", anchor="ra")
        yield FilmFrame(time_ns, np.asarray(canvas))


def frame_rows(table: Table) -> Iterator[tuple[int, float, Block, int]]:
    """Yield the time of each frame (ns since 1970, s from the start), and its row in a block of the grid."""
    for block in table.grid():
        times_s = np.asarray(block["time_s"], np.float64)
        for row in range(0, len(times_s), STEPS):
            time_s = float(times_s[row])
            yield table.start_ns + round(time_s * 1e9), time_s, block, row


def panel(drawing: PoseRenderer, block: Block, row: int, robot: str, title: str) -> Image.Image:
    """Return the drawing of one robot with its title."""
    arms, head = (
        np.array([np.asarray(block[f"{robot}{axis}_deg"], np.float64)[row] for axis in axes])
        for axes in (ARMS, HEAD)
    )
    if np.isnan(arms).any() or np.isnan(head).any():
        image = Image.new("RGB", PANEL, BACKGROUND)
        write(image, (PANEL[0] // 2, PANEL[1] // 2), "no samples", anchor="mm")
    else:
        image = Image.fromarray(drawing.picture(arms, head))
    write(image, (16, 12), title)
    return image


def decoded(jpeg: bytes) -> Image.Image | None:
    """Return a picture; None if it is damaged."""
    try:
        return Image.open(io.BytesIO(jpeg)).convert("RGB")
    except OSError:
        return None
