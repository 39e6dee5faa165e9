"""The frames of films: the pictures of an eye, or simulation and hardware beside each other."""

from __future__ import annotations

import io
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Final, NamedTuple

import av
import numpy as np
import numpy.typing as npt
from av.video.reformatter import ColorRange, Colorspace
from av.video.stream import VideoStream
from PIL import Image, ImageDraw, ImageFont

from beatrix_zenoh.body.figure import Figure, meshes
from beatrix_zenoh.body.scene import HeadDrawing, Screen, Viewpoint, draw
from beatrix_zenoh.contract.names import ARMS, SIDE_TITLES, SIDES
from beatrix_zenoh.motion.rotation import rotation_of
from beatrix_zenoh.recording.export import Block, Table
from beatrix_zenoh.recording.samples import EyePicture
from beatrix_zenoh.recording.series import HEAD

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]
"""(height, width, 3) red, green, blue"""

BACKGROUND: Final = (236, 239, 243)
VIEW: Final = Viewpoint(azimuth=-31.0, elevation=13.0, zoom=0.84, height=-0.001)
"""About as in the recording's side-by-side view, with the whole robot in every pose."""
SMOOTHING: Final = 2
"""Pixels are drawn this much smaller in both directions, and averaged."""
STEPS: Final = 2
"""Steps of the grid of 20 ms between two frames: 25 frames a second."""
PANEL: Final = (640, 480)
"""Size of the drawing of one robot (pixels)."""
INK: Final = (45, 52, 60)


class FilmFrame(NamedTuple):
    """A picture of a film, and its time (ns since 1970)."""

    time_ns: int
    pixels: Pixels


class PoseRenderer:
    """Pictures of one robot in the poses that are asked for."""

    def __init__(self, figure: Figure, width: int, height: int) -> None:
        """Prepare pictures of this size (pixels)."""
        self._figure = figure
        self.screen = Screen(VIEW, width * SMOOTHING, height * SMOOTHING)
        self._last: tuple[tuple[float, ...], Pixels] | None = None

    def picture(self, arms_deg: Array, head_deg: Array) -> Pixels:
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


def write(image: Image.Image, at: tuple[int, int], text: str, *, anchor: str = "la") -> None:
    """Write text into a picture; the anchor is Pillow's."""
    font = ImageFont.load_default(size=20)
    ImageDraw.Draw(image).text(at, text, fill=INK, font=font, anchor=anchor)


TICKS: Final = 90_000
"""Ticks of a film's time in a second, the usual number for H.264."""
RATE: Final = 25
"""Frames a second that the file announces; the time of each frame is its own."""
OPTIONS: Final = {"crf": "20", "preset": "veryfast"}
"""Quality and speed of libx264: a film of two robots is not distinguishable from its frames."""


def write_video(path: Path, frames: Iterable[FilmFrame]) -> int:
    """Write a film with the times of its frames, and return their number; without frames there is no file.

    Raises:
        OSError: the file cannot be written.
    """
    waiting = iter(frames)
    first = next(waiting, None)
    if first is None:
        return 0
    count = 0
    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = new_stream(container, first)
        for count, frame in enumerate(itertools.chain([first], waiting), start=1):  # noqa: B007
            picture = av.VideoFrame.from_ndarray(frame.pixels, format="rgb24")
            picture.time_base = Fraction(1, TICKS)
            picture.pts = round((frame.time_ns - first.time_ns) * TICKS / 1e9)
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
    return count


def new_stream(container: av.container.OutputContainer, frame: FilmFrame) -> VideoStream:
    """Add the stream of pictures to a file, in the size of the first frame."""
    stream = container.add_stream("libx264", rate=RATE, options=OPTIONS)
    stream.height, stream.width = frame.pixels.shape[:2]
    stream.pix_fmt = "yuv420p"  # browsers show no other one
    # Players guess the colours of a large picture otherwise, and wrong ones.
    stream.codec_context.colorspace = Colorspace.ITU601
    stream.codec_context.color_range = ColorRange.MPEG
    stream.codec_context.time_base = Fraction(1, TICKS)
    stream.time_base = Fraction(1, TICKS)
    return stream
